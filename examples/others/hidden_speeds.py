"""Gymnasium's pendulum over gravity, its speed hidden: a policy with a memory, by RecurrentPPO.

surmount check hidden_speeds:make_env
surmount reproduce hidden_speeds:make_env --preset smoke --config hidden_speeds.toml --out runs/p
"""

import gymnasium
import numpy as np

from surmount import TaskEnv, TaskSpace


def set_task(env, task):
    env.g = task["gravity_mps2"]


def make_env():
    seen = gymnasium.spaces.Box(-1, 1, (2,), np.float32)
    pendulum = gymnasium.make("Pendulum-v1", max_episode_steps=100)
    return TaskEnv(
        gymnasium.wrappers.TransformObservation(pendulum, lambda whole: whole[:2], seen),
        space=TaskSpace.grid(gravity_mps2=np.linspace(1, 11, 6), harder={"gravity_mps2": 1}),
        set_task=set_task,
        success=lambda transition: transition.observation[0] > 0.9,  # upright at the end
        features={
            "cosine": lambda transition: transition.observation[0],
            "sine": lambda transition: transition.observation[1],
        },
    )
