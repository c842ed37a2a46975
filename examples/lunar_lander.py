"""Gymnasium's lunar lander over gravity and wind: an environment with two task parameters.

surmount check lunar_lander:make_env
surmount reproduce lunar_lander:make_env --preset smoke --out runs/lander
"""

import gymnasium
import numpy as np

from surmount import TaskEnv, TaskSpace


def set_task(env, task):
    env.gravity = -task["gravity_mps2"]
    env.wind_power = task["wind_power"]


def make_env():
    return TaskEnv(
        gymnasium.make("LunarLanderContinuous-v3", enable_wind=True, max_episode_steps=400),
        space=TaskSpace.grid(gravity_mps2=np.linspace(4, 11, 4), wind_power=np.linspace(0, 15, 4)),
        set_task=set_task,
        success=lambda transition: transition.terminated and transition.reward >= 100,  # at rest
        features={
            "x": lambda transition: transition.observation[0],
            "y": lambda transition: transition.observation[1],
            "tilt_rad": lambda transition: transition.observation[4],
        },
        observe_task=True,
    )
