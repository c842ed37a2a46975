"""A curriculum in words, as lines of plain text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surmount.analysis.features import describe_variant
from surmount.core.arrays import FloatArray
from surmount.core.axis import CONTINUOUS, Axes, Axis, full_axes
from surmount.tasks.curriculum import Box, Curriculum

_SHOWN_BOXES = 3
_FEWEST = 3
"""Values that tell how far apart neighbours are."""


def describe_curriculum(curriculum: Curriculum) -> list[str]:
    """Return groups, ranges, success, levels and weights of a curriculum as lines of text."""
    n_groups, n_levels = len(curriculum.groups), curriculum.n_levels
    size = f"{counted(n_groups, 'group')}, {counted(n_levels, 'level')}"
    lines = [
        f"Curriculum over {', '.join(curriculum.parameters)}: {size}",
        "",
        *table_lines(*group_table(curriculum)),
        "",
    ]
    if not curriculum.levels:
        return [*lines, describe_no_levels(curriculum)]
    return [*lines, *table_lines(*level_table(curriculum))]


def group_table(curriculum: Curriculum) -> tuple[list[str], list[list[str]]]:
    """Return groups with variants, success and ranges: a header, and a row for each."""
    rows = [
        [
            group.name,
            describe_variants(group.variants, curriculum.axes),
            f"{group.success_rate:.1%}",
            _describe_boxes(group.boxes, curriculum.axes),
        ]
        for group in curriculum.groups
    ]
    return ["group", "variants", "success", "range"], rows


def level_table(curriculum: Curriculum) -> tuple[list[str], list[list[str]]]:
    """Return levels with the weight of each group: a header, and a row for each."""
    rows = [
        [str(number), level.dominant, *(f"{weight:.3g}" for weight in level.weights)]
        for number, level in enumerate(curriculum.levels, start=1)
    ]
    return ["level", "for", *(group.name for group in curriculum.groups)], rows


def describe_no_levels(curriculum: Curriculum) -> str:
    """Return why a curriculum has no levels, as far as it tells."""
    threshold = curriculum.success_threshold
    learnt = all(group.success_rate >= threshold for group in curriculum.groups)
    return f"No levels{f': every group reaches {threshold:.0%} success' if learnt else ''}."


def describe_variants(variants: FloatArray, axes: Axes = ()) -> str:
    """Return variants in few words: ``21–33 (13)``, or ``12 within 20–35 × 0.4–1``.

    Categories are a set: ``flat, slope``, or ``12 within 20–35 × {flat, slope}``.
    """
    along = full_axes(axes, variants[0])
    if variants.shape[1] > 1:
        if variants.shape[0] <= _SHOWN_BOXES:
            return ", ".join(describe_variant(variant, along) for variant in variants)
        return f"{variants.shape[0]} within {_describe_span(variants, along)}"
    values, axis = variants[:, 0], along[0]
    if values.size < _FEWEST or axis.categorical:
        return ", ".join(axis.text(value) for value in values)
    parts = [
        f"{axis.text(run[0])}–{axis.text(run[-1])}" if run.size > 1 else axis.text(run[0])
        for run in runs(values, axis)
    ]
    return f"{', '.join(parts)} ({values.size})"


def runs(values: FloatArray, axis: Axis = CONTINUOUS) -> list[FloatArray]:
    """Split ascending values where the next is further away than the nearest neighbours are.

    Of two values nothing is known of what lies between: each is a run; so is each category.
    """
    if values.size < _FEWEST or axis.categorical:
        return [values[i : i + 1] for i in range(values.size)]
    gaps = np.diff(axis.scale(values))
    return np.split(values, np.flatnonzero(gaps > 1.5 * gaps.min()) + 1)


def table_lines(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return rows as lines of aligned columns."""
    widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]

    def line(cells: Sequence[str]) -> str:
        aligned = (cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
        return ("  " + "  ".join(aligned)).rstrip()

    return [line(header), line(["-" * width for width in widths]), *(line(row) for row in rows)]


def _describe_boxes(boxes: Sequence[Box], axes: Axes) -> str:
    if len(boxes) <= _SHOWN_BOXES or (len(axes) == 1 and axes[0].categorical):
        return ", ".join(_describe_span(np.stack([box.lower, box.upper]), axes) for box in boxes)
    ends = np.concatenate([[box.lower, box.upper] for box in boxes])
    return f"{len(boxes)} within {_describe_span(ends, axes)}"


def _describe_span(points: FloatArray, axes: Axes) -> str:
    """Return what points, shape ``(point, parameter)``, span along each axis."""
    return " × ".join(
        describe_side(axis, column) for axis, column in zip(axes, points.T, strict=True)
    )


def describe_side(axis: Axis, values: FloatArray) -> str:
    """Return what values span along one axis: ``20–35``, ``flat`` or ``{flat, slope}``."""
    distinct = np.unique(values)
    if distinct.size == 1:
        return axis.text(distinct[0])
    if axis.categorical:
        return f"{{{', '.join(axis.text(value) for value in distinct)}}}"
    return f"{axis.text(distinct[0])}–{axis.text(distinct[-1])}"


def counted(number: int, noun: str) -> str:
    """Return ``"1 level"`` or ``"3 levels"``."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
