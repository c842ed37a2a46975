"""Episodes of random actions, by which the contract of an environment is checked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.envs.observations import numbers
from surmount.envs.task_env import TaskEnv

LONGEST_EPISODE = 20_000
"""Decisions after which an episode counts as without end."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Episode:
    """An episode of random actions.

    Attributes
    ----------
    observations
        As the wrapped environment returned them, without an appended task, shape
        ``(decision + 1, observation)``.
    rewards, features
        Shapes ``(decision,)`` and ``(decision + 1, feature)``.
    variant
        The task that the infos told.
    ended
        Whether it came to an end.
    is_success
        What the infos told at its end.
    """

    observations: FloatArray
    rewards: FloatArray
    features: FloatArray
    variant: FloatArray
    ended: bool
    is_success: bool


def episode_of(
    env: TaskEnv,
    task: FloatArray,
    seed: int,
    longest: int = LONGEST_EPISODE,
    *,
    action_seed: int | None = None,
) -> Episode:
    """Run one episode of random actions on a task.

    The actions depend on ``action_seed`` alone, which is the episode's seed if not given. The
    episode is left after ``longest`` decisions where it has not ended by then.
    """
    space = env.action_space
    space.seed(seed if action_seed is None else action_seed)
    _, info = env.reset(seed=seed, options={"variant": task})
    observations, rewards, features = [_raw(env)], [], [info["features"]]
    ended = False
    while not ended and len(rewards) < longest:
        _, reward, terminated, truncated, info = env.step(space.sample())
        observations.append(_raw(env))
        rewards.append(float(reward))
        features.append(info["features"])
        ended = terminated or truncated
    return Episode(
        observations=np.array(observations),
        rewards=np.array(rewards),
        features=np.array(features),
        variant=np.asarray(info["variant"], dtype=np.float64),
        ended=ended,
        is_success=bool(info["is_success"]),
    )


def same(first: Episode, second: Episode) -> bool:
    """Return whether observations and rewards are equal, bit by bit."""
    return np.array_equal(first.observations, second.observations) and np.array_equal(
        first.rewards, second.rewards
    )


def _raw(env: TaskEnv) -> FloatArray:
    """Return what the wrapped environment returned last as numbers, shape ``(observation,)``."""
    return numbers(env.last_observation)
