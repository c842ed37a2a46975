"""Checking the contract of an environment before hours are spent on it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import SurmountError, cause
from surmount.envs.making import make_task_env, time_limit
from surmount.envs.observations import is_image, require_usual, text_entries
from surmount.envs.probing import LONGEST_EPISODE, Episode, episode_of, interleaved, same
from surmount.envs.task_env import TaskEnv, UntoldSuccessError, UnusableStartError
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.space import TaskSpace, describe_range

EPISODES = 3
"""Episodes of random actions per variant that is tried."""
TRIED = 5
"""Variants that are tried, evenly over the grid."""
MOST_PAIRS = 10
"""Pairs of episodes in which two seeds may make no difference."""
SAMPLES_NEEDED = 20
"""Moments of a variant that the analysis needs (its ``min_samples_per_component``)."""
USUAL_REPETITIONS = 8
"""Trials of each variant and network in the smaller preset."""
MOST_DIVERGED = 0.5
"""Share of episodes that may end because the simulation diverged."""
SHOWN_PLACES = 8
"""Places in an observation that are named."""
FEWEST_OF_SERIES = 3
"""Values that make a series."""


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
    findings: dict[str, Finding] = {}
    for finding in contract_findings(make_env, seed=seed):
        findings.pop(finding.clause, None)
        findings[finding.clause] = finding
    return list(findings.values())


def contract_findings(make_env: Callable[[], object], *, seed: int = 0) -> Iterator[Finding]:
    """Give the findings of :func:`check_contract` one by one, as soon as each is known.

    A clause comes a second time where it held at first and broke while others were checked.
    """
    try:
        for finding in _clauses(make_env, seed):
            yield finding
            if not finding.holds and finding.clause in _FATAL:
                return
    except UntoldSuccessError as error:
        yield _broken("success is told", error)
    except UnusableStartError as error:
        yield _broken(_FINITE, error)
    except SurmountError as error:
        yield _broken("episodes run", error)
    except TimeoutError as error:
        yield Finding(
            clause="it answers in time",
            holds=False,
            sentence=str(error),
            remedy="Shorten episodes, or give the check more time; if one step takes so long, "
            "training will take for ever.",
        )
    except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever it is, it is told
        yield Finding(
            clause="episodes run",
            holds=False,
            sentence=cause(error),
            remedy="Correct what it says; reset and step must not fail.",
        )


_FINITE = "observations and rewards are finite"
_FATAL = ("it can be made", "episodes run", "episodes end")


def _clauses(make_env: Callable[[], object], seed: int) -> Iterator[Finding]:
    try:
        env = make_task_env(make_env)
    except SurmountError as error:
        yield _broken("it can be made", error)
        return
    yield Finding(clause="it can be made", holds=True, sentence=f"{env.env}")
    yield _space(env.space)
    yield _spaces(env)
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
    yield _finite(episodes)
    yield _rewards(episodes)
    yield from _features(env, episodes)
    yield _success(episodes)
    yield _enough(episodes)
    for index in range(len(env.space.parameters)):
        yield _task_matters(env, index, seed)
    yield _repeats(env, tried[-1], seed)
    apart = _apart(make_env, env, seed)
    if apart is not None:
        yield apart
    yield _seeds_matter(env, tried[-1], seed)
    yield _distribution_holds(env, seed)
    env.close()


def _broken(clause: str, error: SurmountError) -> Finding:
    return Finding(clause=clause, holds=False, sentence=error.message, remedy=error.remedy)


def _space(space: TaskSpace) -> Finding:
    """Say what the task parameters are taken to be: it decides what training draws."""
    even = [
        name
        for name, axis, values in zip(space.parameters, space.axes, space.variants.T, strict=True)
        if axis.kind == "continuous" and _evenly_logarithmic(np.unique(values))
    ]
    return Finding(
        clause="task parameters have axes",
        holds=True,
        sentence="; ".join(describe_range(space, index) for index in range(len(space.parameters))),
        note=f"The values of {', '.join(f'`{name}`' for name in even)} are even in their "
        f'logarithm, but training draws evenly between them: declare axes={{"{even[0]}": '
        '"logarithmic"}} in TaskSpace.grid.'.replace("}}", "}")
        if even
        else "",
    )


def _evenly_logarithmic(values: FloatArray) -> bool:
    """Return whether values, ascending, follow a geometric series over a factor of ten or more."""
    if values.size < FEWEST_OF_SERIES or values[0] <= 0 or values[-1] < 10.0 * values[0]:
        return False
    return bool(np.ptp(np.diff(np.log(values))) < 1e-6)


def _spaces(env: TaskEnv) -> Finding:
    clause = "a learner can take observations and actions"
    try:
        require_usual(env.observation_space, env.action_space)
    except SurmountError as error:
        return _broken(clause, error)
    text = text_entries(env.env.observation_space)
    return Finding(
        clause=clause,
        holds=True,
        sentence=f"observations {_described(env.observation_space)}, actions {env.action_space}",
        note=f"`{'`, `'.join(text)}` is text: it is left out, for no network reads it."
        if text
        else "",
    )


def _described(space: gymnasium.Space[Any]) -> str:
    if is_image(space):
        return f"pictures {space.shape}, for a policy with convolutions"
    if isinstance(space, gymnasium.spaces.Dict):
        return f"a dictionary of {', '.join(space.spaces)}"
    return f"{space.shape}" if isinstance(space, gymnasium.spaces.Box) else f"{space}"


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


def _finite(episodes: list[Episode]) -> Finding:
    """Say whether episodes ended because something was not finite, and what; few of them may."""
    ends = [episode.unusable for episode in episodes if episode.unusable is not None]
    if not ends:
        return Finding(clause=_FINITE, holds=True, sentence="over all episodes")
    broken = ~np.isfinite(ends)
    places = np.flatnonzero(broken.any(axis=0)).tolist()
    # A simulation that blows up leaves NaN, or every number infinite; a sensor without an echo is
    # infinite by itself.
    sensor = bool(places) and not np.isnan(ends).any() and not broken.all(axis=1).any()
    unusable = "rewards"
    if places:
        unusable = f"observation {', '.join(map(str, places[:SHOWN_PLACES]))}" + (
            f" and {len(places) - SHOWN_PLACES} more" if len(places) > SHOWN_PLACES else ""
        )
    ended = f"{len(ends)} of {len(episodes)} episodes ended because the simulation diverged"
    holds = not sensor and len(ends) <= MOST_DIVERGED * len(episodes)
    return Finding(
        clause=_FINITE,
        holds=holds,
        sentence="over most episodes"
        if holds
        else f"not finite: {unusable}" + ("" if sensor else f"; {ended}"),
        remedy="These are infinite while the others are finite, as a range sensor's without an "
        "echo: clip them to the sensor's range in an ObservationWrapper, as in "
        "np.clip(observation, low, high). An episode that ends because of them would end early."
        if sensor
        else "End an episode before its state is no longer finite, and let each reward be a "
        "number.",
        note=f"{ended} (not finite: {unusable}): look whether random actions can be that violent."
        if holds
        else "",
    )


def _rewards(episodes: list[Episode]) -> Finding:
    values = np.unique(np.concatenate([episode.rewards for episode in episodes]))
    alike = values.size == 1
    return Finding(
        clause="rewards tell progress",
        holds=True,
        sentence=f"every step is rewarded by {values[0]:g}" if alike else "they differ",
        note="Eq. 5 sees no progress in rewards of steps that are all alike; with "
        "`advancement.measure` at its default, episode, it sees how long episodes are, and "
        "nothing else. Reward what comes closer to the goal, or reaching it."
        if alike
        else "",
    )


def _enough(episodes: list[Episode]) -> Finding:
    moments: dict[bytes, list[int]] = {}
    for episode in episodes:
        moments.setdefault(episode.variant.tobytes(), []).append(len(episode.features))
    fewest = min(float(np.mean(lengths)) for lengths in moments.values())
    trials = int(np.ceil(SAMPLES_NEEDED / fewest))
    return Finding(
        clause="trials are long enough to be analysed",
        holds=True,
        sentence=f"{fewest:.0f} moments an episode on the shortest variant",
        note=f"A variant needs {SAMPLES_NEEDED} moments for one component of its mixture, better "
        f"ten times as many: give --trials.repetitions at least {trials}."
        if trials > USUAL_REPETITIONS
        else "",
    )


def _apart(make_env: Callable[[], object], env: TaskEnv, seed: int) -> Finding | None:
    """Run two environments in turn on the two ends of each range; the first must not notice."""
    space = env.space
    tasks = np.stack([space.lower, space.upper])
    alone, again = (episode_of(env, tasks[0], seed) for _ in range(2))
    if not same(alone, again):
        return None  # a difference would say nothing; that a seed repeats is another clause
    other = make_task_env(make_env)
    beside = interleaved(env, other, tasks, seed)
    other.close()
    return Finding(
        clause="environments do not share their task",
        holds=same(alone, beside),
        sentence="two, step by step in turn on other tasks"
        if same(alone, beside)
        else "step by step in turn with another environment on another task, the same seed and "
        "actions give another episode",
        remedy="Keep the task in the environment itself (`env.x = …`), not in a module or a class: "
        "a vector environment holds several in one process.",
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
    axis, lower, upper = space.axes[index], space.lower[index], space.upper[index]
    if len(space.variants) == 1 or lower == upper:
        return Finding(
            clause=clause,
            holds=False,
            sentence="there is one variant, which is no family"
            if len(space.variants) == 1
            else f"it has one value, {axis.text(lower)}",
            remedy="Give it several values in the task space, or leave it out where others vary.",
        )
    task = space.variants[len(space.variants) // 2].copy()
    task[index] = lower
    first, again = (episode_of(env, task, seed) for _ in range(2))
    # Where a category changes anything it may be any of them, not the last.
    others = np.unique(space.variants[:, index])[1:].tolist() if axis.categorical else [upper]
    last = first
    while others and same(first, last):
        task[index] = upper = others.pop(0)
        last = episode_of(env, task, seed)
    low, high = axis.text(lower), axis.text(upper)
    if not same(first, again):
        return Finding(
            clause=clause,
            holds=False,
            sentence=f"not shown: at {low} the same seed and actions do not give the same episode "
            "twice, so that a difference says nothing",
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
        sentence=f"the same seed and actions give the same episode at {low} and {high}"
        if same(first, last)
        else f"between {low} and {high} {what}",
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
    """Two seeds, the same actions: where the episode begins must differ, or what happens in it.

    Chance that strikes now and then may pass by a short episode: several are tried.
    """
    differ = any(
        not np.array_equal(first.observations, second.observations)
        for first, second in (
            [episode_of(env, task, one, 50, action_seed=pair) for one in (seed, seed + 1 + pair)]
            for pair in range(MOST_PAIRS)
        )
    )
    return Finding(
        clause="seeds matter",
        holds=differ,
        sentence="two seeds, the same actions",
        remedy="Let `reset` draw the start from `self.np_random`; else all trials of a policy "
        "without noise are one trial.",
    )


def _distribution_holds(env: TaskEnv, seed: int) -> Finding:
    middle = env.space.variants[len(env.space.variants) // 2]
    narrow = TaskDistribution.uniform(env.space.parameters, middle, middle, env.space.axes)
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
