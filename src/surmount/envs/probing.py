"""Episodes of random actions, by which the contract of an environment is checked."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.envs.observations import numbers
from surmount.envs.task_env import TaskEnv

LONGEST_EPISODE = 20_000
"""Steps after which an episode counts as without end."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Episode:
    """An episode of random actions.

    Attributes
    ----------
    observations
        As the wrapped environment returned them, without an appended task, shape
        ``(step + 1, observation)``.
    rewards, features
        Shapes ``(step,)`` and ``(step + 1, feature)``.
    variant
        The task that the infos told.
    ended
        Whether it came to an end.
    is_success
        What the infos told at its end.
    unusable
        The observation that ended it as diverged, shape ``(observation,)``, or ``None``.
    """

    observations: FloatArray
    rewards: FloatArray
    features: FloatArray
    variant: FloatArray
    ended: bool
    is_success: bool
    unusable: FloatArray | None


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
    episode is left after ``longest`` steps where it has not ended by then.
    """
    playing = _playing(env, task, seed, longest, seed if action_seed is None else action_seed)
    episode: Episode | None = None
    for episode in playing:  # noqa: B007 - the last is whole
        pass
    assert episode is not None  # noqa: S101 - there is one after the reset
    return episode


def interleaved(env: TaskEnv, beside: TaskEnv, tasks: FloatArray, seed: int) -> Episode:
    """Run an episode of an environment, step by step in turn with one of another environment.

    Parameters
    ----------
    env, beside
        Two environments that one function made.
    tasks
        Of each, ``(2, parameter)``.
    seed
        Of both episodes and their actions.

    Returns
    -------
    Episode
        That of the first.
    """
    episode: Episode | None = None
    other = _playing(beside, tasks[1], seed, LONGEST_EPISODE, seed)
    for episode in _playing(env, tasks[0], seed, LONGEST_EPISODE, seed):  # noqa: B007 - see above
        next(other, None)
    assert episode is not None  # noqa: S101 - there is one after the reset
    return episode


def _playing(
    env: TaskEnv, task: FloatArray, seed: int, longest: int, action_seed: int
) -> Iterator[Episode | None]:
    """Reset and step, yielding after each; the episode comes last."""
    space = env.action_space
    space.seed(action_seed)
    _, info = env.reset(seed=seed, options={"variant": task})
    observations, rewards, features = [_raw(env)], [], [info["features"]]
    ended = False
    while not ended and len(rewards) < longest:
        yield None
        _, reward, terminated, truncated, info = env.step(space.sample())
        observations.append(_raw(env))
        rewards.append(float(reward))
        features.append(info["features"])
        ended = terminated or truncated
    yield Episode(
        observations=np.array(observations),
        rewards=np.array(rewards),
        features=np.array(features),
        variant=np.asarray(info["variant"], dtype=np.float64),
        ended=ended,
        is_success=bool(info["is_success"]),
        unusable=None if env.unusable is None else numbers(env.unusable),
    )


def same(first: Episode, second: Episode) -> bool:
    """Return whether observations and rewards are equal, bit by bit."""
    return np.array_equal(first.observations, second.observations) and np.array_equal(
        first.rewards, second.rewards
    )


def _raw(env: TaskEnv) -> FloatArray:
    """Return what the wrapped environment returned last as numbers, shape ``(observation,)``."""
    return numbers(env.last_observation)
