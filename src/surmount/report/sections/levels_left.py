"""How far each level's own group was when the level was left: what eq. 5 does not look at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from surmount.report.document.parts import Block, Column, Notice, Table
from surmount.report.document.text import UNDEFINED, counted, percent
from surmount.report.results import TrainingResult
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.regions import Regions

NEWEST = 50
"""Newest episodes of a level's own group that are counted, all from within the level."""
FEWEST = 10
"""Episodes below which its success counts as not known."""


@dataclass(frozen=True, kw_only=True)
class LevelLeft:
    """One level of one network at its end.

    Attributes
    ----------
    level
        Counted from 0.
    success
        Share of the newest episodes of the level's own group; ``None`` with too few.
    """

    level: int
    success: float | None


def levels_left(training: TrainingResult, curriculum: Curriculum) -> list[LevelLeft]:
    """Return how often the own group of each level succeeded when the level was left."""
    episodes = training.record
    if episodes is None:
        return []
    owner = Regions.of(curriculum).index(episodes.tasks)
    names = [group.name for group in curriculum.groups]
    found: list[LevelLeft] = []
    begun = 0
    for test in training.level_tests:
        if test.decision == "extend":
            continue
        own = owner == names.index(curriculum.levels[test.level].dominant)
        own &= (episodes.steps > begun) & (episodes.steps <= test.steps)
        newest = episodes.success[own][-NEWEST:]
        rate = float(newest.mean()) if newest.size >= FEWEST else None
        found.append(LevelLeft(level=test.level, success=rate))
        begun = test.steps
    return found


def levels_left_blocks(
    trainings: Mapping[int, TrainingResult], curriculum: Curriculum
) -> list[Block]:
    """Return a table of all networks and levels, and a warning where groups were not mastered."""
    left = {network: levels_left(training, curriculum) for network, training in trainings.items()}
    if not any(left.values()):
        return []
    numbers = range(curriculum.n_levels)
    table = Table(
        label="",
        title="Success in each level's own group when the level was left",
        columns=(
            Column(heading="network"),
            *(
                Column(heading=f"level {i + 1}, {curriculum.levels[i].dominant}", numeric=True)
                for i in numbers
            ),
        ),
        rows=tuple(
            (str(network), *(_rate(ends, level) for level in numbers))
            for network, ends in left.items()
        ),
        notes=(
            (
                f"Share of the newest {NEWEST} training episodes of the group that the level is "
                f"for, from random starts; {UNDEFINED} with fewer than {FEWEST}."
            ),
        ),
    )
    known = [end.success for ends in left.values() for end in ends if end.success is not None]
    short = sum(rate < curriculum.success_threshold for rate in known)
    if not short:
        return [table]
    sentence = (
        f"{short} of {counted(len(known), 'level')} ended before "
        f"{percent(curriculum.success_threshold)} of the newest episodes of their own group "
        "succeeded. Eq. 5 tests whether the reward still grows, not whether a group is mastered; "
        "longer iterations (`advancement.iteration_steps`) give a level more time."
    )
    return [
        Notice(title="Levels left before their group was mastered", sentences=(sentence,)),
        table,
    ]


def _rate(ends: Sequence[LevelLeft], level: int) -> str:
    return next((percent(end.success) for end in ends if end.level == level), UNDEFINED)
