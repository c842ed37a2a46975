"""Whether the variants of a curriculum's groups lie where the groups' boxes say.

Some teachers draw from boxes, others pool episodes by variants: where the two contradict each
other, an edit of one of them would change nothing for half of the teachers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.axis import Axes, variant_text

_ROUNDING = 1e-9
"""Share of the range of a parameter by which a variant may lie beyond a bound."""
_SHOWN = 5
"""Variants of a group that are named."""


def place_problems(groups: Sequence[Mapping[str, Any]], axes: Axes) -> list[str]:
    """Return where variants and boxes contradict each other, as phrases.

    A variant lies in a box of its group, and within none of another group's unless a box of its
    own holds it alone; no variant lies in two groups.

    Parameters
    ----------
    groups
        In JSON form, each sound by itself.
    axes
        One per parameter.
    """
    names = [str(group["name"]) for group in groups]
    variants = [_stored(group["variants"], axes) for group in groups]
    lower = [_stored([box["lower"] for box in group["boxes"]], axes) for group in groups]
    upper = [_stored([box["upper"] for box in group["boxes"]], axes) for group in groups]
    slack = _ROUNDING * np.ptp(np.concatenate([*variants, *lower, *upper]), axis=0)
    problems: list[str] = []
    for own, name in enumerate(names):
        outside = ~_within(variants[own], lower[own] - slack, upper[own] + slack)
        if outside.any():
            told = _told(variants[own][outside], name, axes)
            problems.append(f"{told} in none of its boxes")
        point = (lower[own] == upper[own]).all(axis=1)
        alone = _within(variants[own], lower[own][point], upper[own][point])
        for other in range(len(names)):
            if other == own:
                continue
            shared = (variants[own][:, None] == variants[other]).all(axis=2).any(axis=1)
            if shared.any() and own < other:
                told = _told(variants[own][shared], name, axes)
                problems.append(f"{told} in group `{names[other]}` as well")
            inside = _inside(variants[own], lower[other], upper[other], slack)
            foreign = inside & ~shared & ~alone
            if foreign.any():
                told = _told(variants[own][foreign], name, axes)
                problems.append(f"{told} within the boxes of group `{names[other]}`")
    return problems


def _stored(points: Sequence[Sequence[Any]], axes: Axes) -> FloatArray:
    """Return points as numbers, shape ``(point, parameter)``."""
    return np.array([[axis.stored(one) for axis, one in zip(axes, point, strict=True)]
                     for point in points])  # fmt: skip


def _within(points: FloatArray, lower: FloatArray, upper: FloatArray) -> BoolArray:
    """Return which points lie in one of the boxes, their bounds included, ``(point,)``."""
    return np.array([((lower <= point) & (point <= upper)).all(axis=1).any() for point in points])


def _inside(
    points: FloatArray, lower: FloatArray, upper: FloatArray, slack: FloatArray
) -> BoolArray:
    """Return which points lie in the interior of one of the boxes, ``(point,)``.

    A side without width, as of a category, is its own interior.
    """
    flat = lower == upper
    low, high = np.where(flat, lower, lower + slack), np.where(flat, upper, upper - slack)
    return np.array(
        [
            (np.where(flat, point == low, (low < point) & (point < high))).all(axis=1).any()
            for point in points
        ]
    )


def _told(variants: FloatArray, group: str, axes: Axes) -> str:
    """Return some variants of a group, the first few of many, and their verb."""
    texts = [variant_text(axes, variant) for variant in variants[:_SHOWN]]
    shown = ", ".join(f"({text})" if len(axes) > 1 else text for text in texts)
    if len(variants) == 1:
        return f"variant {shown} of group `{group}` lies"
    more = f" and {len(variants) - _SHOWN} more" if len(variants) > _SHOWN else ""
    return f"variants {shown}{more} of group `{group}` lie"
