"""Checking the contract of an environment before hours are spent on it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import gymnasium
import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import SurmountError
from surmount.core.tasks import TaskDistribution
from surmount.own.task_env import TaskEnv

LONGEST_EPISODE = 20_000
"""Decisions after which an episode counts as without end."""
EPISODES = 3
"""Episodes of random actions per variant that is tried."""
TRIED = 5
"""Variants that are tried, evenly over the grid."""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One clause of the contract, and whether it holds.

    Attributes
    ----------
    clause
        In a few words.
    holds
        Whether it does.
    sentence
        What was seen.
    remedy
        What to do where it does not hold, else empty.
    """

    clause: str
    holds: bool
    sentence: str
    remedy: str = ""


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
    raw_infos
        Keys of ``info`` at its end.
    is_success
        What the infos told at its end.
    """

    observations: FloatArray
    rewards: FloatArray
    features: FloatArray
    variant: FloatArray
    ended: bool
    raw_infos: frozenset[str]
    is_success: bool


def check_contract(make_env: Callable[[], object], *, seed: int = 0) -> list[Finding]:
    """Verify that an environment keeps the contract, by episodes of random actions.

    Parameters
    ----------
    make_env
        Makes one environment.
    seed
        Of episodes and actions.

    Returns
    -------
    list
        One finding per clause, in the order in which they were checked. A clause that cannot be
        checked because an earlier one fails is left out.
    """
    findings: list[Finding] = []
    for finding in _clauses(make_env, seed):
        findings.append(finding)
        if not finding.holds and finding.clause in _FATAL:
            break
    return findings


_FATAL = ("it can be made", "episodes run", "episodes end")


def _clauses(make_env: Callable[[], object], seed: int) -> Iterator[Finding]:
    try:
        env = make_env()
    except Exception as error:  # noqa: BLE001 - whatever it is, it is told
        yield _failed("it can be made", error, "Let the function run by itself first.")
        return
    if not isinstance(env, TaskEnv):
        yield Finding(
            clause="it can be made",
            holds=False,
            sentence=f"The function returned {type(env).__name__}, not a TaskEnv.",
            remedy="Return surmount.own.TaskEnv(env, space=…, set_task=…, success=…, features=…).",
        )
        return
    yield Finding(clause="it can be made", holds=True, sentence=f"{env.env}")
    yield _boxes(env)
    variants = env.space.variants
    tried = variants[np.unique(np.linspace(0, len(variants) - 1, TRIED).round().astype(int))]
    try:
        episodes = [
            episode_of(env, task, seed + repeat) for task in tried for repeat in range(EPISODES)
        ]
    except SurmountError as error:
        yield Finding(
            clause="episodes run", holds=False, sentence=error.message, remedy=error.remedy
        )
        return
    except Exception as error:  # noqa: BLE001 - whatever it is, it is told
        yield _failed("episodes run", error, "Correct what it says; reset and step must not fail.")
        return
    yield Finding(
        clause="episodes run",
        holds=True,
        sentence=f"{len(episodes)} episodes on {len(tried)} variants, "
        f"{sum(episode.rewards.size for episode in episodes)} decisions",
    )
    yield _ends(episodes)
    yield _finite(env, episodes)
    yield from _features(env, episodes)
    yield _success(env, episodes)
    yield from _task_matters(env, seed)
    yield _repeats(env, tried[-1], seed)
    yield _seeds_matter(env, tried[-1], seed)
    yield _distribution_holds(env, seed)
    env.close()


def episode_of(env: TaskEnv, task: FloatArray, seed: int) -> Episode:
    """Run one episode of random actions on a task; the actions depend on the seed alone."""
    space = env.action_space
    space.seed(seed)
    _, info = env.reset(seed=seed, options={"variant": task})
    observations, rewards, features = [_raw(env)], [], [info["features"]]
    ended = False
    while not ended and len(rewards) < LONGEST_EPISODE:
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
        raw_infos=frozenset(info),
        is_success=bool(info["is_success"]),
    )


def _raw(env: TaskEnv) -> FloatArray:
    return np.asarray(env.last_observation, dtype=np.float64).ravel()


def _failed(clause: str, error: Exception, remedy: str) -> Finding:
    return Finding(
        clause=clause, holds=False, sentence=f"{type(error).__name__}: {error}", remedy=remedy
    )


def _boxes(env: TaskEnv) -> Finding:
    spaces = (env.observation_space, env.action_space)
    return Finding(
        clause="observations and actions are boxes",
        holds=all(isinstance(space, gymnasium.spaces.Box) for space in spaces),
        sentence=f"observations {env.observation_space.shape}, actions {env.action_space}",
        remedy="The whole protocol needs boxes; with others, use the callback in a script of your "
        "own.",
    )


def _ends(episodes: list[Episode]) -> Finding:
    longest = max(episode.rewards.size for episode in episodes)
    return Finding(
        clause="episodes end",
        holds=all(episode.ended for episode in episodes),
        sentence=f"the longest took {longest} decisions",
        remedy="Wrap the environment in gymnasium.wrappers.TimeLimit.",
    )


def _finite(env: TaskEnv, episodes: list[Episode]) -> Finding:
    parts = [part for episode in episodes for part in (episode.observations, episode.rewards)]
    outside = any(
        isinstance(env.env.observation_space, gymnasium.spaces.Box)
        and not np.isfinite(episode.observations).all()
        for episode in episodes
    )
    return Finding(
        clause="observations and rewards are finite",
        holds=not outside and all(np.isfinite(part).all() for part in parts),
        sentence="over all episodes",
        remedy="End an episode before its state is no longer finite.",
    )


def _features(env: TaskEnv, episodes: list[Episode]) -> Iterator[Finding]:
    values = np.concatenate([episode.features for episode in episodes])
    names = env.feature_names
    infinite = [name for name, good in zip(names, np.isfinite(values.T), strict=True)
                if not good.all()]  # fmt: skip
    yield Finding(
        clause="features are finite",
        holds=not infinite,
        sentence=f"not finite: {', '.join(infinite)}" if infinite else f"{', '.join(names)}",
        remedy="Let them be numbers at every moment, the first included.",
    )
    constant = [name for name, span in zip(names, np.ptp(values, axis=0), strict=True)
                if span == 0]  # fmt: skip
    yield Finding(
        clause="features vary",
        holds=not constant,
        sentence=f"constant: {', '.join(constant)}" if constant else "each over the episodes",
        remedy="Take features that behaviour changes, and leave constant ones out.",
    )


def _success(env: TaskEnv, episodes: list[Episode]) -> Finding:
    key = env.success_key
    rate = float(np.mean([episode.is_success for episode in episodes]))
    if key is not None and not all(key in episode.raw_infos for episode in episodes):
        return Finding(
            clause="success is told",
            holds=False,
            sentence=f"`info` holds no `{key}` when an episode ends",
            remedy=f"Let the environment put `{key}` into `info`, or give a function as `success`.",
        )
    return Finding(
        clause="success is told",
        holds=True,
        sentence=f"{100 * rate:.0f} % of random episodes succeed"
        + ("; so nothing is left to learn" if rate == 1.0 else ""),
    )


def _task_matters(env: TaskEnv, seed: int) -> Iterator[Finding]:
    """With the same seed and actions, two ends of a parameter's range must differ."""
    space = env.space
    for index, name in enumerate(space.parameters):
        task = space.variants[len(space.variants) // 2].copy()
        ends: list[Episode] = []
        for bound in (space.lower, space.upper):
            task[index] = bound[index]
            ends.append(episode_of(env, task, seed))
        common = min(len(end.observations) for end in ends)
        gap = np.abs(ends[0].observations[:common] - ends[1].observations[:common]).max(axis=1)
        differs = bool((gap > 0).any()) or len(ends[0].rewards) != len(ends[1].rewards)
        rewards = ends[0].rewards[: common - 1] != ends[1].rewards[: common - 1]
        first = int(np.argmax(gap > 0)) if (gap > 0).any() else -1
        told = [end.variant[index] for end in ends] == [space.lower[index], space.upper[index]]
        where = "at once" if first == 0 else f"after {first} decisions"
        yield Finding(
            clause=f"{name} changes the task",
            holds=(differs or bool(rewards.any())) and told,
            sentence=f"observations at {space.lower[index]:g} and {space.upper[index]:g} differ "
            f"{where}"
            if differs
            else f"the same seed and actions give the same episode at {space.lower[index]:g} and "
            f"{space.upper[index]:g}",
            remedy="Let `set_task` change what the simulation reads: often an attribute is copied "
            "when the environment is made, and a later change is ignored.",
        )


def _repeats(env: TaskEnv, task: FloatArray, seed: int) -> Finding:
    first, second = (episode_of(env, task, seed) for _ in range(2))
    return Finding(
        clause="a seed repeats its episode",
        holds=np.array_equal(first.observations, second.observations),
        sentence="the same task, seed and actions, twice in a row",
        remedy="Draw everything random from `self.np_random`, and let `reset` restore everything; "
        "without, an interrupted training cannot go on identically.",
    )


def _seeds_matter(env: TaskEnv, task: FloatArray, seed: int) -> Finding:
    """Two seeds, the same actions: where the episode begins must differ, or what happens in it."""
    episodes: list[FloatArray] = []
    for one in (seed, seed + 1):
        env.reset(seed=one, options={"variant": task})
        env.action_space.seed(0)
        observations = [_raw(env)]
        for _ in range(50):
            _, _, terminated, truncated, _ = env.step(env.action_space.sample())
            observations.append(_raw(env))
            if terminated or truncated:
                break
        episodes.append(np.array(observations))
    return Finding(
        clause="seeds matter",
        holds=not np.array_equal(episodes[0], episodes[1]),
        sentence="two seeds, the same actions",
        remedy="Let `reset` draw the start from `self.np_random`; else all trials of a policy "
        "without noise are one trial.",
    )


def _distribution_holds(env: TaskEnv, seed: int) -> Finding:
    middle = env.space.variants[len(env.space.variants) // 2]
    narrow = TaskDistribution.uniform(env.space.parameters, middle, middle)
    env.set_task_distribution(narrow)
    env.reset(seed=seed)
    told = [env.reset()[1]["variant"] for _ in range(3)]
    env.set_task_distribution(env.space.whole_range)
    return Finding(
        clause="a distribution holds over resets",
        holds=all(np.array_equal(task, middle) for task in told),
        sentence="three resets without options",
        remedy="Do not override `reset` of TaskEnv.",
    )
