"""Named parts of the space of tasks, such as a curriculum's groups, to measure by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.axis import Axes
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.distribution import TaskDistribution


@dataclass(frozen=True, kw_only=True, eq=False)
class Regions:
    """Unions of boxes with names; where they meet, a task belongs to the first.

    Attributes
    ----------
    names
        One per region.
    lower, upper
        Bounds of each region's boxes, each of shape ``(box, parameter)``.
    """

    names: tuple[str, ...]
    lower: tuple[FloatArray, ...]
    upper: tuple[FloatArray, ...]

    @classmethod
    def of(cls, curriculum: Curriculum) -> Self:
        """Return the groups of a curriculum."""
        groups = curriculum.groups
        return cls(
            names=tuple(group.name for group in groups),
            lower=tuple(np.stack([box.lower for box in group.boxes]) for group in groups),
            upper=tuple(np.stack([box.upper for box in group.boxes]) for group in groups),
        )

    def index(self, tasks: FloatArray) -> IntArray:
        """Return the region of each task, −1 outside all.

        Parameters
        ----------
        tasks
            Shape ``(task, parameter)``.

        Returns
        -------
        IntArray
            Shape ``(task,)``.
        """
        found = np.full(len(tasks), -1, dtype=np.int64)
        for region in reversed(range(len(self.names))):
            found[self._inside(region, tasks)] = region
        return found

    def shares(self, distribution: TaskDistribution) -> FloatArray:
        """Return the probability that a distribution gives to each region, ``(region,)``.

        Shares are taken on the scale of each of the distribution's axes.
        """
        axes = distribution.axes
        point = (distribution.upper == distribution.lower).all(axis=1)
        shares = np.zeros(len(self.names))
        owner = self.index(distribution.lower[point])
        np.add.at(shares, owner[owner >= 0], distribution.weights[point][owner >= 0])
        spread = ~point
        boxes = _sides(axes, distribution.lower[spread], distribution.upper[spread])
        for region in range(len(self.names)):
            sides = _sides(axes, self.lower[region], self.upper[region])
            for lower, upper in zip(*sides, strict=True):
                overlap = _overlap(*boxes, lower, upper)
                shares[region] += float(distribution.weights[spread] @ overlap)
        return shares

    def _inside(self, region: int, tasks: FloatArray) -> BoolArray:
        lower, upper = self.lower[region][:, None], self.upper[region][:, None]
        return np.asarray(
            ((lower <= tasks) & (tasks <= upper)).all(axis=2).any(axis=0), dtype=np.bool_
        )


def success_by_region(
    regions: Regions, tasks: FloatArray, success: Sequence[bool] | BoolArray
) -> list[float | None]:
    """Return the success rate in each region, ``None`` where there was no task."""
    owner, outcome = regions.index(tasks), np.asarray(success, dtype=np.float64)
    return [
        float(outcome[owner == region].mean()) if (owner == region).any() else None
        for region in range(len(regions.names))
    ]


def _sides(axes: Axes, lower: FloatArray, upper: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return bounds of boxes on the scales of their axes, each of shape ``(box, parameter)``."""
    sides = [axis.sides(lower[:, k], upper[:, k]) for k, axis in enumerate(axes)]
    low, high = zip(*sides, strict=True)
    return np.stack(low, axis=1), np.stack(high, axis=1)


def _overlap(
    lower: FloatArray, upper: FloatArray, box_lower: FloatArray, box_upper: FloatArray
) -> FloatArray:
    """Return the share of each box that lies in one box; a flat side lies in it or not."""
    width = upper - lower
    common = np.clip(np.minimum(upper, box_upper) - np.maximum(lower, box_lower), 0.0, None)
    flat = (box_lower <= lower) & (lower <= box_upper)
    share = np.where(width > 0, common / np.where(width > 0, width, 1.0), flat)
    return share.prod(axis=1)
