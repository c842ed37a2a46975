"""Gymnasium's lunar lander over gravity and wind: to tune teachers on, not to judge them.

Nothing is known of its right groups. What lands at little wind lands at much gravity too, so that
difficulty rises with the wind above all; runs take minutes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from surmount.tasks.space import TaskSpace

LONGEST_EPISODE = 400
"""Steps after which an episode is cut (assumed: a landing takes some 250)."""
STEP_S = 0.02
"""Length of a step: the lander's simulation has 50 frames per second."""


def make_lander() -> Any:
    """Make one lander; gravity within what the environment allows, wind up to its advice."""
    # Box2D is an extra of Gymnasium, needed by those who fly.
    import gymnasium  # noqa: PLC0415

    from surmount.envs.task_env import TaskEnv  # noqa: PLC0415

    return TaskEnv(
        gymnasium.make(
            "LunarLanderContinuous-v3", enable_wind=True, max_episode_steps=LONGEST_EPISODE
        ),
        space=TaskSpace.grid(
            gravity_mps2=np.linspace(4, 11, 5).tolist(), wind_power=np.linspace(0, 15, 6).tolist()
        ),
        set_task=_set_task,
        success=_landed,
        features={
            "x": lambda transition: transition.observation[0],
            "y": lambda transition: transition.observation[1],
            "tilt_rad": lambda transition: transition.observation[4],
        },
        observe_task=True,
        step_s=STEP_S,
    )


def _set_task(env: Any, task: Any) -> None:
    env.gravity = -task["gravity_mps2"]
    env.wind_power = task["wind_power"]


def _landed(transition: Any) -> bool:
    return bool(transition.terminated and transition.reward >= 100)  # at rest
