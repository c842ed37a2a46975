"""How much of each group was practised in each level, beside uniform sampling."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.report.document.parts import Block, Column, Table
from surmount.report.document.text import UNDEFINED, percent
from surmount.report.figures.curves import levels_left_before
from surmount.report.results import TrainingResult
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.regions import Regions

PRACTISED = (
    "Share of the episodes that were of each group, and in brackets of the learning steps that "
    "they took, over all networks: a failed episode takes longer than one that succeeds, so that "
    "what is hard takes more steps than draws."
)


def exposure(
    trainings: Iterable[TrainingResult], regions: Regions, n_levels: int
) -> tuple[FloatArray, FloatArray]:
    """Count what was practised, over all networks.

    Parameters
    ----------
    trainings
        Those of one arm; what has no record of its episodes counts for nothing.
    regions
        The groups.
    n_levels
        Levels of the curriculum; 1 for an arm without.

    Returns
    -------
    tuple
        Episodes that ended in each level and group, and the learning steps that they took, each
        ``(level, group)``. Tasks between groups are in none.
    """
    counts = np.zeros((2, n_levels, len(regions.names)))
    for training in trainings:
        if training.record is None:
            continue
        group = regions.index(training.record.tasks)
        level = np.minimum(levels_left_before(training, training.record.steps), n_levels - 1)
        inside = group >= 0
        places = (level[inside], group[inside])
        np.add.at(counts[0], places, 1)
        np.add.at(counts[1], places, training.record.length[inside])
    return counts[0], counts[1]


def exposure_blocks(
    curriculum_arm: Mapping[int, TrainingResult],
    control_arm: Mapping[int, TrainingResult],
    curriculum: Curriculum,
) -> list[Block]:
    """Return a table of the levels, all of them together and the control, by group."""
    regions = Regions.of(curriculum)
    episodes, steps = exposure(curriculum_arm.values(), regions, max(1, curriculum.n_levels))
    if not curriculum.levels or not episodes.any():
        return []
    lines = [
        (f"level {i + 1}, {level.dominant}", episodes[i], steps[i])
        for i, level in enumerate(curriculum.levels)
    ]
    lines.append(("all levels", episodes.sum(axis=0), steps.sum(axis=0)))
    control = exposure(control_arm.values(), regions, 1)
    lines.append(("control, uniform", control[0][0], control[1][0]))
    return [
        Table(
            label="",
            title="What was practised",
            columns=(
                Column(heading="level"),
                *(Column(heading=name, numeric=True) for name in regions.names),
            ),
            rows=tuple(
                (name, *_shares(of_episodes, of_steps)) for name, of_episodes, of_steps in lines
            ),
            notes=(PRACTISED,),
        )
    ]


def _shares(episodes: FloatArray, steps: FloatArray) -> list[str]:
    if not episodes.any():
        return [UNDEFINED] * len(episodes)
    return [
        f"{percent(float(drawn))} ({percent(float(taken))})"
        for drawn, taken in zip(episodes / episodes.sum(), steps / steps.sum(), strict=True)
    ]
