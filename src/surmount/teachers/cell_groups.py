"""Which cell belongs to which group, for teachers that pool the episodes of a group."""

from __future__ import annotations

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.axis import variant_text
from surmount.tasks.cells import TaskCells
from surmount.tasks.curriculum import Curriculum


class CellGroups:
    """The cells of all variants, each in a group.

    Attributes
    ----------
    cells
        One per variant.
    names
        Of the groups, easiest first.
    group
        Group of each cell, ``(variant,)``.
    sizes
        Cells of each group, ``(group,)``.
    """

    def __init__(self, cells: TaskCells, names: tuple[str, ...], group: IntArray) -> None:
        self.cells = cells
        self.names = names
        self.group = group
        self.sizes: IntArray = np.bincount(group, minlength=len(names)).astype(np.int64)

    @classmethod
    def of(cls, cells: TaskCells, curriculum: Curriculum) -> CellGroups:
        """Return the groups of a curriculum.

        A variant that belongs to no group, as in a curriculum edited by hand, joins the group of
        the nearest variant that has one.
        """
        group = curriculum.groups_of(cells.variants)
        known = np.flatnonzero(group >= 0)
        extent = np.ptp(cells.variants, axis=0)
        scaled = cells.variants / np.where(extent > 0, extent, 1.0)
        for cell in np.flatnonzero(group < 0):
            distance = np.square(scaled[known] - scaled[cell]).sum(axis=1)
            group[cell] = group[known[int(distance.argmin())]]
        return cls(cells, tuple(each.name for each in curriculum.groups), group)

    @classmethod
    def single(cls, cells: TaskCells) -> CellGroups:
        """Return every cell as a group of its own: nothing is pooled."""
        names = tuple(variant_text(cells.axes, task) for task in cells.variants)
        return cls(cells, names, np.arange(cells.count))

    @property
    def record(self) -> dict[str, object]:
        """What saved progress belongs to, as JSON values."""
        return {"variants": self.cells.variants.tolist(), "groups": self.group.tolist()}

    def totals(self, by_cell: FloatArray) -> FloatArray:
        """Return the sum over the cells of each group, ``(group,)``."""
        totals: FloatArray = np.zeros(len(self.names))
        np.add.at(totals, self.group, by_cell)
        return totals

    def practised_most(self, weights: FloatArray) -> tuple[int, float]:
        """Return the group that a distribution over cells favours most, and by how much.

        Favour is the group's probability by what uniform draws of cells would give it.
        """
        favour = self.totals(weights) * weights.size / self.sizes
        most = int(favour.argmax())
        return most, float(favour[most])
