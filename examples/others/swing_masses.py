"""Gymnasium's acrobot over the mass of its lower link: discrete actions, learnt by DQN.

surmount check swing_masses:make_env
surmount reproduce swing_masses:make_env --preset smoke --config swing_masses.toml --out runs/swing
"""

import gymnasium
import numpy as np

from surmount import TaskEnv, TaskSpace


def set_task(env, task):
    env.LINK_MASS_2 = task["lower_link_kg"]


def height_m(transition):
    cos_1, sin_1, cos_2, sin_2 = transition.observation[:4]
    return -cos_1 - (cos_1 * cos_2 - sin_1 * sin_2)


def make_env():
    return TaskEnv(
        gymnasium.make("Acrobot-v1", max_episode_steps=200),
        space=TaskSpace.grid(lower_link_kg=np.linspace(0.25, 1.5, 6)),
        set_task=set_task,
        success=lambda transition: transition.terminated,
        features={
            "height_m": height_m,
            "upper_speed_radps": lambda transition: transition.observation[4],
        },
        observe_task=True,
    )
