"""What a teacher does, written to Stable-Baselines3's logger.

========================================  ====================================================
key                                       value
========================================  ====================================================
``curriculum/level``                      level in force, from 1, of teachers that have levels
``curriculum/steps_to_test``              learning steps until that level is tested
``curriculum/weight/<region>``            probability of the region in what is pushed
``curriculum/success/<region>``           success of the region's episodes in the roll-out
``curriculum/diverged``                   share of the roll-out's episodes that diverged
``curriculum/tested_level``               level just tested, from 1
``curriculum/rF``, ``rL``                 r over the first and the last W steps (eq. 5): mean
                                          reward of episodes, or sum of step rewards
``curriculum/rF_episodes``, …             how many episodes each is the mean of
``curriculum/first_gain``                 rL − rF of the level's first iteration
``curriculum/newest_gain``                rL − rF of the newest iteration
``curriculum/eq5_ratio``, ``threshold``   newest gain / first gain, and what it must fall below
``curriculum/advanced``                   1 where the level was left, 0 where it was extended
========================================  ====================================================

Level and weights are those of the roll-out to come, success and what diverged are those of the
roll-out just done; the keys from ``tested_level`` on are written where a level was tested, of them
gains and ratio where they can be told. Long names of regions are shortened (:func:`short_names`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from stable_baselines3.common.logger import Logger

from surmount.tasks.cells import cells
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.regions import Regions, success_by_region
from surmount.tasks.space import TaskSpace
from surmount.teachers.teacher import LevelTest, RolloutOutcome, TeacherStatus

MOST_REGIONS = 24
"""Variants beyond which each having a curve of its own would hide the others."""
LONGEST_NAME = 25
"""Characters of a name that Stable-Baselines3's table of 36 columns can show."""


def log_curriculum(
    logger: Logger,
    *,
    distribution: TaskDistribution | None,
    outcome: RolloutOutcome,
    test: LevelTest | None,
    regions: Regions | None,
    status: TeacherStatus,
) -> None:
    """Record one roll-out.

    Parameters
    ----------
    logger
        Of Stable-Baselines3, with whatever outputs it has.
    distribution
        What environments draw from now; ``None`` once the teacher is finished.
    outcome
        What the roll-out brought.
    test
        The level test made on it, if one was due.
    regions
        Parts of the space of tasks to tell apart; without, weights and success are not recorded.
    status
        Of the teacher, from now on.
    """
    if regions is not None:
        names = short_names(regions.names)
        rates = success_by_region(regions, outcome.episodes.variant, outcome.episodes.success)
        for name, rate in zip(names, rates, strict=True):
            if rate is not None:
                logger.record(f"curriculum/success/{name}", rate)
        if distribution is not None:
            for name, share in zip(names, regions.shares(distribution), strict=True):
                logger.record(f"curriculum/weight/{name}", float(share))
    if outcome.episodes.diverged.size:
        logger.record("curriculum/diverged", float(outcome.episodes.diverged.mean()))
    if status.level is not None:
        logger.record("curriculum/level", status.level)
    if status.steps_to_test is not None:
        logger.record("curriculum/steps_to_test", status.steps_to_test)
    if test is not None:
        logger.record("curriculum/tested_level", test.level + 1)
        measured = {
            "rF": test.first_window,
            "rL": test.last_window,
            "rF_episodes": test.first_episodes,
            "rL_episodes": test.last_episodes,
            "first_gain": test.first_gain,
            "newest_gain": test.newest_gain,
            "eq5_ratio": test.ratio,
        }
        for name, value in measured.items():
            if value is not None:
                logger.record(f"curriculum/{name}", value)
        logger.record("curriculum/threshold", test.threshold)
        logger.record("curriculum/advanced", int(test.decision != "extend"))


def short_names(names: Sequence[str]) -> list[str]:
    """Return names of at most :data:`LONGEST_NAME` characters, which stay as different as they are.

    Stable-Baselines3's table refuses names that are alike as far as it shows them.
    """
    taken = {name: name for name in names if len(name) <= LONGEST_NAME}
    for name in names:
        if name not in taken:
            taken[name] = next(short for short in _shortened(name) if short not in taken.values())
    return [taken[name] for name in names]


def _shortened(name: str) -> Iterator[str]:
    """Yield shorter forms of a name: its beginning and its end, with a number from 2 on between."""
    for number in itertools.count(1):
        mark = "…" if number == 1 else f"…{number}…"
        head, odd = divmod(LONGEST_NAME - len(mark), 2)
        yield f"{name[: head + odd]}{mark}{name[-head:]}"


def variant_regions(space: TaskSpace) -> Regions | None:
    """Return one region per variant, named by its values.

    ``None`` where there are more variants than :data:`MOST_REGIONS`, or their names are longer
    than :data:`LONGEST_NAME` or alike.
    """
    names = tuple(map(space.text, space.variants))
    unclear = len(set(names)) < len(names) or max(map(len, names)) > LONGEST_NAME
    if unclear or len(names) > MOST_REGIONS:
        return None
    lower, upper = cells(space.variants, space.axes)
    return Regions(names=names, lower=tuple(lower[:, None]), upper=tuple(upper[:, None]))
