"""Gymnasium's half cheetah up a slope: a MuJoCo locomotion task over the slope's angle.

The slope is made by tilting gravity over a flat floor; no geometry changes.

surmount check uphill_cheetah:make_env
surmount reproduce uphill_cheetah:make_env --preset smoke --out runs/cheetah
"""

import gymnasium
import numpy as np

from surmount import TaskEnv, TaskSpace

GRAVITY_MPS2 = 9.81
GOAL_M = 2.0


def set_task(env, task):
    slope = np.radians(task["slope_deg"])  # the floor's frame: gravity leans against the run
    env.model.opt.gravity[:] = [-GRAVITY_MPS2 * np.sin(slope), 0, -GRAVITY_MPS2 * np.cos(slope)]


def make_env():
    return TaskEnv(
        gymnasium.make("HalfCheetah-v5", max_episode_steps=200),
        space=TaskSpace.grid(slope_deg=np.linspace(0, 30, 7), harder={"slope_deg": 1}),
        set_task=set_task,
        success=lambda transition: transition.info["x_position"] >= GOAL_M,
        features={
            "x_m": "x_position",
            "height_m": lambda transition: transition.observation[0],
            "pitch_rad": lambda transition: transition.observation[1],
        },
        end_on_success=True,
        observe_task=True,
    )
