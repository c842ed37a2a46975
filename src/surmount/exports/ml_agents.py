"""Curricula for Unity ML-Agents: ``environment_parameters`` in YAML.

ML-Agents draws from several intervals by ``multirangeuniform``, choosing each in proportion to its
length and knowing no weights. Weights are encoded by naming an interval several times; the error
that remains is said.
"""

from __future__ import annotations

import json

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.curriculum import Curriculum
from surmount.core.errors import InputError
from surmount.core.tasks import TaskDistribution
from surmount.exports.export import Export

MOST_INTERVALS = 400
"""Intervals of one level at the most."""
GOOD_ERROR = 0.005
"""Error of a weight at which no more intervals are tried."""
INDEX = "variant_index"
"""Parameter that stands for a box of several parameters."""


def export_ml_agents(
    curriculum: Curriculum, *, behavior: str = "Robot", threshold: float = 0.5
) -> Export:
    """Return one file with all levels as lessons, and one file per level.

    Parameters
    ----------
    curriculum
        With at least one level.
    behavior
        Name of the behaviour in Unity whose progress ends a lesson.
    threshold
        Share of ``max_steps`` after which the last lesson begins; the others follow evenly.

    Raises
    ------
    InputError
        If there are no levels, the behaviour's name is empty, or the share is not between 0 and 1.
    """
    if not curriculum.levels:
        raise InputError(
            "The curriculum has no levels, so there is no lesson to write.",
            remedy="Give a curriculum with at least one level.",
        )
    if not behavior or not 0 < threshold < 1:
        raise InputError(
            f"The behaviour is {behavior!r} and the threshold {threshold}.",
            remedy="Name the behaviour, and give a share between 0 and 1.",
        )
    notes: list[str] = []
    levels = [curriculum.level_distribution(level) for level in range(curriculum.n_levels)]
    files: dict[str, str] = {}
    if len(curriculum.parameters) == 1:
        name = curriculum.parameters[0]
        step = _grid_step(curriculum)
        levels = [_widened(level, step, notes) for level in levels]
    else:
        name = INDEX
        levels, files[f"{INDEX}.csv"] = _indexed(levels)
        notes.append(
            "ML-Agents draws each parameter by itself and cannot draw several together: the YAML "
            f"draws `{INDEX}`; in C#, floor it, look the row up in {INDEX}.csv, and draw each "
            "parameter uniformly between the row's bounds."
        )
    lessons = ["environment_parameters:", f"  {name}:", "    curriculum:"]
    for number, level in enumerate(levels, 1):
        counts, error = interval_counts(level.weights, (level.upper - level.lower)[:, 0])
        notes.append(
            f"Level {number}: {int(counts.sum())} intervals; weights are met to within "
            f"{100 * error:.2g} percentage points."
        )
        sampler = _sampler(level, counts)
        label = f"level_{number}_{curriculum.levels[number - 1].dominant}".replace(" ", "_")
        lessons.append(f"      - name: {json.dumps(label)}")
        if number < len(levels):
            share = threshold * number / max(len(levels) - 1, 1)
            lessons += _criteria(behavior, share)
        lessons += ["        value:", *(f"          {line}" for line in sampler)]
        text = ["environment_parameters:", f"  {name}:", *(f"    {line}" for line in sampler)]
        files[f"level_{number}.yaml"] = "\n".join(text) + "\n"
    files["curriculum.yaml"] = "\n".join(lessons) + "\n"
    notes.append(
        "ML-Agents cannot express the test of eq. 5: curriculum.yaml goes on after fixed shares of "
        "max_steps. To keep the test, train level by level: mlagents-learn with level_1.yaml, then "
        "level_2.yaml with --initialize-from=<run before>, and so on, each until its reward no "
        "longer grows."
    )
    notes.append(
        "Copy the `environment_parameters` into your own file beside `behaviors`; read the "
        f"parameter `{name}` once per episode."
    )
    return Export(files=files, notes=tuple(notes))


def interval_counts(weights: FloatArray, lengths: FloatArray) -> tuple[IntArray, float]:
    """Return how often to name each interval so that ML-Agents draws it with its weight.

    Parameters
    ----------
    weights, lengths
        Wanted probability and length of each interval, ``(interval,)``; both positive.

    Returns
    -------
    tuple
        Counts, and the largest difference between a wanted and a realised probability.
    """
    wanted = weights / lengths
    ratio = wanted / wanted.min()
    best: tuple[float, IntArray] | None = None
    scale = 1.0
    while True:
        counts = np.maximum(1, np.rint(scale * ratio)).astype(np.int64)
        if best is not None and counts.sum() > MOST_INTERVALS:
            return best[1], best[0]
        realised = counts * lengths / (counts * lengths).sum()
        error = float(np.abs(realised - weights).max())
        if best is None or error < best[0] - 1e-12:
            best = (error, counts)
        if error <= GOOD_ERROR:
            return counts, error
        scale += 0.25


def _grid_step(curriculum: Curriculum) -> float:
    variants = np.unique(np.concatenate([group.variants[:, 0] for group in curriculum.groups]))
    return float(np.diff(variants).min()) if variants.size > 1 else 1.0


def _widened(level: TaskDistribution, step: float, notes: list[str]) -> TaskDistribution:
    flat = (level.upper - level.lower)[:, 0] <= 0
    if flat.any():
        values = ", ".join(f"{value:g}" for value in level.lower[flat, 0])
        sentence = (
            f"ML-Agents never draws an interval without length: {values} became an interval of "
            f"{step:g}, half the distance between variants to each side."
        )
        if sentence not in notes:
            notes.append(sentence)
    half = np.where(flat, step / 2, 0.0)[:, None]
    return TaskDistribution(
        parameters=level.parameters,
        weights=level.weights,
        lower=level.lower - half,
        upper=level.upper + half,
    )


def _indexed(levels: list[TaskDistribution]) -> tuple[list[TaskDistribution], str]:
    """Return levels over the index of a box, and the table of boxes."""
    boxes: dict[tuple[float, ...], int] = {}
    for level in levels:
        for bounds in np.column_stack([level.lower, level.upper]).tolist():
            boxes.setdefault(tuple(bounds), len(boxes))
    names = levels[0].parameters
    header = [INDEX, *(f"{name}_lower" for name in names), *(f"{name}_upper" for name in names)]
    rows = [",".join(header)]
    rows += [",".join([str(index), *map(repr, bounds)]) for bounds, index in boxes.items()]
    indexed: list[TaskDistribution] = []
    for level in levels:
        bounds = np.column_stack([level.lower, level.upper]).tolist()
        index = np.array([[float(boxes[tuple(one)])] for one in bounds])
        indexed.append(
            TaskDistribution(
                parameters=(INDEX,), weights=level.weights, lower=index, upper=index + 1.0
            )
        )
    return indexed, "\n".join(rows) + "\n"


def _sampler(level: TaskDistribution, counts: IntArray) -> list[str]:
    intervals = [
        [float(low), float(high)]
        for low, high, count in zip(level.lower[:, 0], level.upper[:, 0], counts, strict=True)
        for _ in range(count)
    ]
    return [
        "sampler_type: multirangeuniform",
        "sampler_parameters:",
        f"  intervals: {json.dumps(intervals)}",
    ]


def _criteria(behavior: str, share: float) -> list[str]:
    return [
        "        completion_criteria:",
        "          measure: progress",
        f"          behavior: {json.dumps(behavior)}",
        "          signal_smoothing: true",
        "          min_lesson_length: 100",
        f"          threshold: {share:.6g}",
        "          require_reset: false",
    ]
