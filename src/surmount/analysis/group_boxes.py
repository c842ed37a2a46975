"""Where groups lie in the continuous space of tasks: the bounds LBᵢ, UBᵢ of eq. 4."""

from __future__ import annotations

import numpy as np

from surmount.analysis.configuration import BoundsRule
from surmount.core.arrays import FloatArray, IntArray
from surmount.core.axis import Axes, full_axes
from surmount.tasks.cells import cells
from surmount.tasks.curriculum import Box


def group_boxes(
    variants: FloatArray, members: IntArray, rule: BoundsRule, axes: Axes = ()
) -> tuple[Box, ...]:
    """Return the boxes of one group.

    With one parameter, each run of neighbouring variants of the group is one interval, weighted
    by its number of variants; a group that is not contiguous has several. With more parameters,
    each variant has a cell of its own; so has each category, for categories have no neighbours: a
    group over them is a set.

    Parameters
    ----------
    variants
        All variants in ascending order, shape ``(variant, parameter)``.
    members
        Indices of the group's variants, ascending.
    rule
        ``"halfway"`` bounds a group half-way to the neighbouring variant of another group;
        ``"range"`` by its own outermost variants. The family's outermost variants bound both.
    axes
        One per parameter; all are continuous where none are given.
    """
    along = full_axes(axes, variants[0])
    lower, upper = cells(variants, along) if rule == "halfway" else (variants, variants)
    joined = len(along) == 1 and not along[0].categorical
    breaks = np.flatnonzero(np.diff(members) > 1) + 1 if joined else np.arange(1, members.size)
    return tuple(
        Box(lower=lower[run[0]], upper=upper[run[-1]], weight=float(run.size))
        for run in np.split(members, breaks)
    )
