"""A curriculum in words, as lines of plain text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surmount.analysis.features import describe_variant
from surmount.core.arrays import FloatArray
from surmount.tasks.curriculum import Box, Curriculum

_SHOWN_BOXES = 3
_FEWEST = 3
"""Values that tell how far apart neighbours are."""


def describe_curriculum(curriculum: Curriculum) -> list[str]:
    """Return groups, ranges, success, levels and weights of a curriculum as lines of text."""
    n_groups, n_levels = len(curriculum.groups), curriculum.n_levels
    rows = [
        [
            group.name,
            describe_variants(group.variants),
            f"{group.success_rate:.1%}",
            _describe_boxes(group.boxes),
        ]
        for group in curriculum.groups
    ]
    size = f"{counted(n_groups, 'group')}, {counted(n_levels, 'level')}"
    lines = [
        f"Curriculum over {', '.join(curriculum.parameters)}: {size}",
        "",
        *table_lines(["group", "variants", "success", "range"], rows),
        "",
    ]
    if not curriculum.levels:
        threshold = curriculum.success_threshold
        learnt = all(group.success_rate >= threshold for group in curriculum.groups)
        why = f": every group reaches {threshold:.0%} success" if learnt else ""
        return [*lines, f"No levels{why}."]
    levels = [
        [str(number), level.dominant, *(f"{weight:.3g}" for weight in level.weights)]
        for number, level in enumerate(curriculum.levels, start=1)
    ]
    names = [group.name for group in curriculum.groups]
    return [*lines, *table_lines(["level", "for", *names], levels)]


def describe_variants(variants: FloatArray) -> str:
    """Return variants in few words: ``21–33 (13)``, or ``12 within 20–35 × 0.4–1``."""
    if variants.shape[1] > 1:
        if variants.shape[0] <= _SHOWN_BOXES:
            return ", ".join(describe_variant(variant) for variant in variants)
        span = Box(lower=variants.min(axis=0), upper=variants.max(axis=0), weight=1.0)
        return f"{variants.shape[0]} within {_describe_box(span)}"
    values = variants[:, 0]
    if values.size < _FEWEST:
        return ", ".join(f"{value:g}" for value in values)
    parts = [f"{run[0]:g}–{run[-1]:g}" if run.size > 1 else f"{run[0]:g}" for run in runs(values)]
    return f"{', '.join(parts)} ({values.size})"


def runs(values: FloatArray) -> list[FloatArray]:
    """Split ascending values where the next is further away than the nearest neighbours are.

    Of two values nothing is known of what lies between: each is a run.
    """
    if values.size < _FEWEST:
        return [values[i : i + 1] for i in range(values.size)]
    gaps = np.diff(values)
    return np.split(values, np.flatnonzero(gaps > 1.5 * gaps.min()) + 1)


def table_lines(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return rows as lines of aligned columns."""
    widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]

    def line(cells: Sequence[str]) -> str:
        aligned = (cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
        return ("  " + "  ".join(aligned)).rstrip()

    return [line(header), line(["-" * width for width in widths]), *(line(row) for row in rows)]


def _describe_boxes(boxes: Sequence[Box]) -> str:
    if len(boxes) <= _SHOWN_BOXES:
        return ", ".join(_describe_box(box) for box in boxes)
    lower = np.min([box.lower for box in boxes], axis=0)
    upper = np.max([box.upper for box in boxes], axis=0)
    return f"{len(boxes)} within {_describe_box(Box(lower=lower, upper=upper, weight=1.0))}"


def _describe_box(box: Box) -> str:
    sides = [
        f"{low:g}" if low == high else f"{low:g}–{high:g}"
        for low, high in zip(box.lower, box.upper, strict=True)
    ]
    return " × ".join(sides)


def counted(number: int, noun: str) -> str:
    """Return ``"1 level"`` or ``"3 levels"``."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
