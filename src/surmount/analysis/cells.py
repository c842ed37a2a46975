"""Where groups lie in the continuous space of tasks: the bounds LBᵢ, UBᵢ of eq. 4."""

from __future__ import annotations

import numpy as np

from surmount.analysis.configuration import BoundsRule
from surmount.core.arrays import FloatArray, IntArray
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


def cells(variants: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a cell for each variant of a family with several parameters.

    Variants on a full grid get the grid's cells, half-way to the neighbours along each parameter
    and ending at the outermost values, so that the cells tile the family's range. Scattered
    variants get boxes that never overlap: along every parameter (in units of the family's range)
    half the distance to the nearest other variant, by the largest difference over parameters,
    cut at the family's range.

    Returns
    -------
    tuple
        Lower and upper bounds, each of shape ``(variant, parameter)``.
    """
    axes = [np.unique(column) for column in variants.T]
    low, high = variants.min(axis=0), variants.max(axis=0)
    if variants.shape[0] == np.prod([axis.size for axis in axes]):
        lower, upper = np.empty_like(variants), np.empty_like(variants)
        for parameter, axis in enumerate(axes):
            middles = 0.5 * (axis[1:] + axis[:-1])
            place = np.searchsorted(axis, variants[:, parameter])
            lower[:, parameter] = np.concatenate([axis[:1], middles])[place]
            upper[:, parameter] = np.concatenate([middles, axis[-1:]])[place]
        return lower, upper
    extent = np.where(high > low, high - low, 1.0)
    scaled = variants / extent
    distance = np.abs(scaled[:, None, :] - scaled[None, :, :]).max(axis=2)
    np.fill_diagonal(distance, np.inf)
    reach = 0.5 * distance.min(axis=1)[:, None] * extent
    return np.maximum(variants - reach, low), np.minimum(variants + reach, high)
