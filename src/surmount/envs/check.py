"""Checking the contract of an environment before hours are spent on it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import gymnasium
import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import SurmountError
from surmount.envs.making import cause, make_task_env, time_limit
from surmount.envs.probing import LONGEST_EPISODE, Episode, episode_of, same
from surmount.envs.task_env import TaskEnv, UntoldSuccessError
from surmount.tasks.distribution import TaskDistribution

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
    note
        What is worth a look although it holds, else empty.
    """

    clause: str
    holds: bool
    sentence: str
    remedy: str = ""
    note: str = ""


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
    try:
        for finding in _clauses(make_env, seed):
            findings.append(finding)
            if not finding.holds and finding.clause in _FATAL:
                return findings
    except UntoldSuccessError as error:
        stopped = _broken("success is told", error)
    except SurmountError as error:
        stopped = _broken("episodes run", error)
    except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever it is, it is told
        stopped = Finding(
            clause="episodes run",
            holds=False,
            sentence=cause(error),
            remedy="Correct what it says; reset and step must not fail.",
        )
    else:
        return findings
    return [finding for finding in findings if finding.clause != stopped.clause] + [stopped]


_FATAL = ("it can be made", "episodes run", "episodes end")


def _clauses(make_env: Callable[[], object], seed: int) -> Iterator[Finding]:
    try:
        env = make_task_env(make_env)
    except SurmountError as error:
        yield _broken("it can be made", error)
        return
    yield Finding(clause="it can be made", holds=True, sentence=f"{env.env}")
    yield _boxes(env)
    try:
        longest = min(time_limit(env), LONGEST_EPISODE)
    except SurmountError as error:
        yield _broken("episodes end", error)
        return
    variants = env.space.variants
    tried = variants[np.unique(np.linspace(0, len(variants) - 1, TRIED).round().astype(int))]
    episodes: list[Episode] = []
    for task, repeat in itertools.product(tried, range(EPISODES)):
        episodes.append(episode_of(env, task, seed + repeat, longest))
        if not episodes[-1].ended:
            break
    yield Finding(
        clause="episodes run",
        holds=True,
        sentence=f"{sum(episode.rewards.size for episode in episodes)} steps, on "
        f"{len({episode.variant.tobytes() for episode in episodes})} of {len(variants)} variants",
    )
    yield _ends(episodes)
    yield _finite(env, episodes)
    yield from _features(env, episodes)
    yield _success(episodes)
    for index in range(len(env.space.parameters)):
        yield _task_matters(env, index, seed)
    yield _repeats(env, tried[-1], seed)
    yield _seeds_matter(env, tried[-1], seed)
    yield _distribution_holds(env, seed)
    env.close()


def _broken(clause: str, error: SurmountError) -> Finding:
    return Finding(clause=clause, holds=False, sentence=error.message, remedy=error.remedy)


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
    ended = all(episode.ended for episode in episodes)
    return Finding(
        clause="episodes end",
        holds=ended,
        sentence=f"the longest took {longest} steps"
        if ended
        else f"one had not ended after {longest} steps",
        remedy="Wrap the environment in gymnasium.wrappers.TimeLimit, with fewer steps where "
        "it has one.",
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
    task_alone = [f"`{name}`" for name in _task_alone(names, episodes) if name not in constant]
    yield Finding(
        clause="features vary",
        holds=not constant,
        sentence=f"constant: {', '.join(constant)}" if constant else "each over the episodes",
        remedy="Take features that behaviour changes, and leave constant ones out.",
        note=f"One value on each variant: {', '.join(task_alone)}. It tells the task, not how it "
        "is done; leave it out."
        if task_alone
        else "",
    )


def _task_alone(names: Sequence[str], episodes: list[Episode]) -> list[str]:
    """Return the features that have one value on each variant, at every moment."""
    of_variant: dict[bytes, list[FloatArray]] = {}
    for episode in episodes:
        of_variant.setdefault(episode.variant.tobytes(), []).append(episode.features)
    spans = [np.ptp(np.concatenate(features), axis=0) for features in of_variant.values()]
    return [name for name, span in zip(names, np.max(spans, axis=0), strict=True) if span == 0]


def _success(episodes: list[Episode]) -> Finding:
    rate = float(np.mean([episode.is_success for episode in episodes]))
    note = ""
    if rate == 0.0:
        note = (
            "Success was never true: random actions may not reach the goal, but make sure that "
            "good ones do."
        )
    elif rate == 1.0:
        note = "Success was always true: then nothing is left to learn, or `success` is too easy."
    return Finding(
        clause="success is told",
        holds=True,
        sentence=f"{100 * rate:.0f} % of random episodes succeed",
        note=note,
    )


def _task_matters(env: TaskEnv, index: int, seed: int) -> Finding:
    """With the same seed and actions, two ends of a parameter's range must differ.

    Only where one end gives the same episode twice does a difference show anything.
    """
    space = env.space
    clause = f"{space.parameters[index]} changes the task"
    lower, upper = space.lower[index], space.upper[index]
    if len(space.variants) == 1 or lower == upper:
        return Finding(
            clause=clause,
            holds=False,
            sentence="there is one variant, which is no family"
            if len(space.variants) == 1
            else f"it has one value, {lower:g}",
            remedy="Give it several values in the task space, or leave it out where others vary.",
        )
    tasks = np.tile(space.variants[len(space.variants) // 2], (3, 1))
    tasks[:, index] = lower, lower, upper
    first, again, last = (episode_of(env, task, seed) for task in tasks)
    if not same(first, again):
        return Finding(
            clause=clause,
            holds=False,
            sentence=f"not shown: at {lower:g} the same seed and actions do not give the same "
            "episode twice, so that a difference says nothing",
            remedy="Let a seed repeat its episode, then check again.",
        )
    told = (first.variant[index], last.variant[index]) == (lower, upper)
    common = min(len(first.observations), len(last.observations))
    apart = (first.observations[:common] != last.observations[:common]).any(axis=1)
    if apart.any():
        steps = int(np.argmax(apart))
        what = f"observations differ {f'from step {steps} on' if steps else 'at once'}"
    else:
        what = "rewards or the end differ"
    return Finding(
        clause=clause,
        holds=told and not same(first, last),
        sentence=f"the same seed and actions give the same episode at {lower:g} and {upper:g}"
        if same(first, last)
        else f"between {lower:g} and {upper:g} {what}",
        remedy="Let `set_task` change what the simulation reads: often an attribute is copied "
        "when the environment is made, and a later change is ignored.",
    )


def _repeats(env: TaskEnv, task: FloatArray, seed: int) -> Finding:
    first, second = (episode_of(env, task, seed) for _ in range(2))
    return Finding(
        clause="a seed repeats its episode",
        holds=same(first, second),
        sentence="the same task, seed and actions, twice in a row",
        remedy="Draw everything random from `self.np_random`, and let `reset` restore everything; "
        "without, an interrupted training cannot go on identically.",
    )


def _seeds_matter(env: TaskEnv, task: FloatArray, seed: int) -> Finding:
    """Two seeds, the same actions: where the episode begins must differ, or what happens in it."""
    first, second = (episode_of(env, task, one, 50, action_seed=0) for one in (seed, seed + 1))
    return Finding(
        clause="seeds matter",
        holds=not np.array_equal(first.observations, second.observations),
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
