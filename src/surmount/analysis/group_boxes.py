"""Where groups lie in the continuous space of tasks: the bounds LBᵢ, UBᵢ of eq. 4."""

from __future__ import annotations

import numpy as np

from surmount.analysis.configuration import BoundsRule
from surmount.core.arrays import FloatArray, IntArray
from surmount.tasks.cells import cells
from surmount.tasks.curriculum import Box


def group_boxes(variants: FloatArray, members: IntArray, rule: BoundsRule) -> tuple[Box, ...]:
    """Return the boxes of one group.

    With one parameter, each run of neighbouring variants of the group is one interval, weighted
    by its number of variants; a group that is not contiguous has several. With more parameters,
    each variant has a cell of its own.

    Parameters
    ----------
    variants
        All variants in ascending order, shape ``(variant, parameter)``.
    members
        Indices of the group's variants, ascending.
    rule
        ``"halfway"`` bounds a group half-way to the neighbouring variant of another group;
        ``"range"`` by its own outermost variants. The family's outermost variants bound both.
    """
    if variants.shape[1] == 1:
        return _intervals(variants[:, 0], members, rule)
    lower, upper = cells(variants) if rule == "halfway" else (variants, variants)
    return tuple(Box(lower=lower[i], upper=upper[i], weight=1.0) for i in members)


def _intervals(values: FloatArray, members: IntArray, rule: BoundsRule) -> tuple[Box, ...]:
    breaks = np.flatnonzero(np.diff(members) > 1) + 1
    boxes: list[Box] = []
    for run in np.split(members, breaks):
        low, high = values[run[0]], values[run[-1]]
        if rule == "halfway":
            low = 0.5 * (low + values[max(run[0] - 1, 0)])
            high = 0.5 * (high + values[min(run[-1] + 1, values.size - 1)])
        boxes.append(Box(lower=np.asarray([low]), upper=np.asarray([high]), weight=float(run.size)))
    return tuple(boxes)
