"""Gymnasium's lander over gravity, with a choice for each engine: MultiDiscrete actions, by A2C.

surmount check lander_choices:make_env
surmount reproduce lander_choices:make_env --preset smoke --config lander_choices.toml --out runs/l
"""

import gymnasium
import numpy as np
from gymnasium.wrappers import DiscretizeAction

from surmount import TaskEnv, TaskSpace


def set_task(env, task):
    env.gravity = -task["gravity_mps2"]


def make_env():
    lander = gymnasium.make("LunarLander-v3", continuous=True, max_episode_steps=200)
    return TaskEnv(
        DiscretizeAction(lander, bins=3, multidiscrete=True),
        space=TaskSpace.grid(gravity_mps2=np.linspace(1, 11, 6)),
        set_task=set_task,
        success=lambda transition: transition.reward == 100,  # at rest; a crash is -100
        features={
            "x": lambda transition: transition.observation[0],
            "y": lambda transition: transition.observation[1],
            "sink_speed": lambda transition: -transition.observation[3],
        },
        observe_task=True,
    )
