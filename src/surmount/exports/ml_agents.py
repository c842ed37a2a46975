"""Curricula for Unity ML-Agents: ``environment_parameters`` in YAML.

ML-Agents draws from several intervals by ``multirangeuniform``, choosing each in proportion to its
length and knowing no weights. Weights are encoded by naming an interval several times; the error
that remains is said.
"""

from __future__ import annotations

import csv
import io
import json

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.axis import values_of
from surmount.core.errors import InputError
from surmount.exports.export import Export, require_levels
from surmount.exports.kinds import notes_on_kinds
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.distribution import TaskDistribution

MOST_INTERVALS = 400
"""Intervals of one level at the most, where it has few boxes."""
MOST_PER_BOX = 10
"""Intervals of one level at the most for each of its boxes, where that is more."""
GOOD_ERROR = 0.005
"""Error of the weights at which no more intervals are tried."""
POOR_ERROR = 0.05
"""Error of the weights from which another way is recommended."""
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
        If there are no levels, the behaviour's name is empty, the share is not between 0 and 1,
        or the parameter's name has letters that ML-Agents cannot send.
    """
    require_levels(curriculum)
    if not behavior or not 0 < threshold < 1:
        raise InputError(
            f"The behaviour is {behavior!r} and the threshold {threshold}.",
            remedy="Name the behaviour, and give a share between 0 and 1.",
        )
    notes: list[str] = []
    levels = [curriculum.level_distribution(level) for level in range(curriculum.n_levels)]
    files: dict[str, str] = {}
    if len(curriculum.parameters) == 1:
        name, levels, step = _sent(curriculum, levels, notes)
        levels = [_widened(level, step, notes) for level in levels]
    else:
        name = INDEX
        levels, files[f"{INDEX}.csv"], n_boxes = _indexed(levels)
        notes.append(
            "ML-Agents draws each parameter by itself and cannot draw several together: the YAML "
            f"draws `{INDEX}`; in C#, floor it, clamp it to {n_boxes - 1} (in single precision a "
            f"draw can be the upper bound itself), look the row up in {INDEX}.csv, and draw each "
            "parameter uniformly between the row's bounds."
        )
        notes += notes_on_kinds(curriculum)
    key = _quoted(name)
    lessons = ["environment_parameters:", f"  {key}:", "    curriculum:"]
    for number, level in enumerate(levels, 1):
        counts, error = interval_counts(level.weights, (level.upper - level.lower)[:, 0])
        notes.append(
            f"Level {number}: {int(counts.sum())} intervals; weights are met to within "
            f"{100 * error:.2g} percentage points."
        )
        if error >= POOR_ERROR:
            notes.append(
                f"Level {number} needs more intervals than a file should hold, for a narrow box "
                "stands beside a wide one: `--to csv` has its weights as they are, to draw by in "
                "C#."
            )
        sampler = _sampler(level, counts)
        label = f"level_{number}_{curriculum.levels[number - 1].dominant}".replace(" ", "_")
        lessons.append(f"      - name: {_quoted(label)}")
        if number < len(levels):
            share = threshold * number / max(len(levels) - 1, 1)
            lessons += _criteria(behavior, share)
        lessons += ["        value:", *(f"          {line}" for line in sampler)]
        text = ["environment_parameters:", f"  {key}:", *(f"    {line}" for line in sampler)]
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
        Counts, the first with an error of at most :data:`GOOD_ERROR`, else those with the least
        among no more than :data:`MOST_INTERVALS` intervals, or :data:`MOST_PER_BOX` for each one
        given; and the error: the largest difference between the wanted and the realised
        probability of any of them taken together, so of any group (total variation).
    """
    share = weights / lengths / (weights / lengths).sum()
    best, least = np.ones(weights.size, dtype=np.int64), np.inf
    most = max(MOST_INTERVALS, MOST_PER_BOX * weights.size)
    for total in np.linspace(0, most, MOST_INTERVALS + 1):
        counts = np.maximum(1, np.rint(total * share)).astype(np.int64)
        if counts.sum() > most:
            break
        realised = counts * lengths / (counts * lengths).sum()
        error = float(np.abs(realised - weights).sum() / 2)
        if error < least - 1e-12:
            best, least = counts, error
        if error <= GOOD_ERROR:
            break
    return best, least


def _sent(
    curriculum: Curriculum, levels: list[TaskDistribution], notes: list[str]
) -> tuple[str, list[TaskDistribution], float]:
    """Return what is sent for the only parameter: its name, the levels, the variants' distance.

    ML-Agents draws evenly: a logarithmic parameter is sent as its logarithm, and a whole number or
    a category as what rounds down to it.
    """
    name, (axis,) = _sendable(curriculum.parameters[0]), curriculum.axes
    variants = np.unique(np.concatenate([group.variants[:, 0] for group in curriculum.groups]))

    def moved(low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
        if axis.kind == "logarithmic":
            return np.log10(low), np.log10(high)
        return (low, high + 1.0) if axis.discrete else (low, high)

    if axis.kind == "logarithmic":
        notes.append(f"`log10_{name}` is the logarithm of `{name}`; in C#, raise 10 to it.")
        name, variants = f"log10_{name}", np.log10(variants)
    elif axis.discrete:
        numbered = ", ".join(f"{place} {one}" for place, one in enumerate(axis.names))
        highest = len(axis.names) - 1 if axis.categorical else round(variants.max())
        notes.append(
            f"`{name}` is {f'a category ({numbered})' if numbered else 'a whole number'}; in C#, "
            f"floor it, and clamp it to {highest}."
        )
    sent: list[TaskDistribution] = []
    for level in levels:
        lower, upper = moved(level.lower, level.upper)
        sent.append(
            TaskDistribution(parameters=(name,), weights=level.weights, lower=lower, upper=upper)
        )
    return name, sent, float(np.diff(variants).min()) if variants.size > 1 else 1.0


def _widened(level: TaskDistribution, step: float, notes: list[str]) -> TaskDistribution:
    flat = (level.upper - level.lower)[:, 0] <= 0
    if flat.any():
        values = ", ".join(f"{value:g}" for value in level.lower[flat, 0])
        sentence = (
            f"ML-Agents never draws an interval without length: {values} became an interval of "
            f"{step:g}, half the distance between variants to each side; in C#, clamp what the "
            "environment cannot take."
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


def _indexed(levels: list[TaskDistribution]) -> tuple[list[TaskDistribution], str, int]:
    """Return levels over the index of a box, the table of boxes, and how many there are."""
    boxes: dict[tuple[float, ...], int] = {}
    for level in levels:
        for bounds in np.column_stack([level.lower, level.upper]).tolist():
            boxes.setdefault(tuple(bounds), len(boxes))
    names = levels[0].parameters
    axes = levels[0].axes * 2
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(
        [INDEX, *(f"{name}_lower" for name in names), *(f"{name}_upper" for name in names)]
    )
    writer.writerows(
        [index, *values_of(axes, np.asarray(bounds))] for bounds, index in boxes.items()
    )
    indexed: list[TaskDistribution] = []
    for level in levels:
        bounds = np.column_stack([level.lower, level.upper]).tolist()
        index = np.array([[float(boxes[tuple(one)])] for one in bounds])
        indexed.append(
            TaskDistribution(
                parameters=(INDEX,), weights=level.weights, lower=index, upper=index + 1.0
            )
        )
    return indexed, table.getvalue(), len(boxes)


def _sendable(name: str) -> str:
    if not name.isascii():
        raise InputError(
            f"The parameter `{name}` has letters that ML-Agents cannot send to Unity.",
            remedy="Name it by letters of ASCII in the curriculum's file.",
        )
    return name


def _quoted(text: str) -> str:
    """Return text as a scalar of YAML that no parser takes for anything else.

    JSON's form is YAML's too, but for characters that JSON writes in two halves.
    """
    return "".join(
        ['"', *(json.dumps(one)[1:-1] if one < "\U00010000" else f"\\U{ord(one):08x}"
                for one in text), '"']
    )  # fmt: skip


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
        f"          behavior: {_quoted(behavior)}",
        "          signal_smoothing: true",
        "          min_lesson_length: 100",
        f"          threshold: {share:.6g}",
        "          require_reset: false",
    ]
