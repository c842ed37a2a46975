"""A family of tasks: what the protocol needs to know of environments and their parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from gymnasium.vector import AutoresetMode

from surmount.core.arrays import FloatArray
from surmount.core.tasks import TaskDistribution
from surmount.envs import EnvConfig, ObstacleVectorEnv, find_obstacle
from surmount.learn import TaskVectorEnv


@dataclass(frozen=True, kw_only=True)
class TaskFamily:
    """Environments that differ in one or more task parameters.

    Attributes
    ----------
    whole_range
        Uniform over the continuous range of the parameters: initiation and control draw from it.
    variants
        The grid of variants for trials and tests, shape ``(variant, parameter)``.
    training_env
        Builds so many environments that reset themselves when an episode ends.
    trial_env
        Builds so many environments that stay as they are when an episode ends.
    """

    whole_range: TaskDistribution
    variants: FloatArray
    training_env: Callable[[int], TaskVectorEnv]
    trial_env: Callable[[int], TaskVectorEnv]


def obstacle_family(obstacle: str, config: EnvConfig) -> TaskFamily:
    """Return the variants of one of RSTAR's obstacles (paper III-C)."""
    course = find_obstacle(obstacle)
    parameters = (course.parameter,)

    def build(num_envs: int, mode: AutoresetMode) -> TaskVectorEnv:
        return ObstacleVectorEnv(
            obstacle, num_envs, config=config, n_threads=1, autoreset_mode=mode
        )  # stages run side by side (ADR 3)

    return TaskFamily(
        whole_range=TaskDistribution.uniform(
            parameters, np.array([course.lower]), np.array([course.upper])
        ),
        variants=course.variants[:, None],
        training_env=lambda num_envs: build(num_envs, AutoresetMode.SAME_STEP),
        trial_env=lambda num_envs: build(num_envs, AutoresetMode.DISABLED),
    )
