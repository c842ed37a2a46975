"""Gymnasium's cart-pole over the length of its pole: discrete actions.

surmount check pole_lengths:make_env
surmount reproduce pole_lengths:make_env --preset smoke --config pole_lengths.toml --out runs/poles
"""

import gymnasium
import numpy as np

from surmount import TaskEnv, TaskSpace


def set_task(env, task):
    env.length = task["pole_m"] / 2  # the simulation's is half the pole's
    env.polemass_length = env.masspole * env.length


def make_env():
    return TaskEnv(
        gymnasium.make("CartPole-v1", max_episode_steps=200),
        space=TaskSpace.grid(pole_m=np.linspace(0.2, 3.2, 6)),
        set_task=set_task,
        success=lambda transition: transition.truncated and not transition.terminated,
        features={
            "cart_m": lambda transition: transition.observation[0],
            "tilt_rad": lambda transition: transition.observation[2],
        },
        observe_task=True,
    )
