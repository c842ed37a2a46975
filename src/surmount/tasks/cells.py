"""The range of tasks cut into one cell per variant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.tasks.distribution import TaskDistribution


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


class TaskCells:
    """One cell per variant, half-way to its neighbours.

    Training draws from the continuous range; a teacher that chooses among variants chooses a cell,
    and the environment draws uniformly within it.

    Parameters
    ----------
    parameters
        Names of the task parameters.
    variants
        Shape ``(variant, parameter)``.

    Attributes
    ----------
    parameters, variants
        As given.
    lower, upper
        Bounds of the cells, shape ``(variant, parameter)``.
    """

    def __init__(self, parameters: tuple[str, ...], variants: FloatArray) -> None:
        self.parameters = parameters
        self.variants = np.asarray(variants, dtype=np.float64).reshape(-1, len(parameters))
        if self.variants.shape[0] == 0:
            raise InputError("There are no variants.", remedy="Give at least one.")
        self.lower, self.upper = cells(self.variants)
        extent = np.ptp(self.variants, axis=0)
        self._extent = np.where(extent > 0, extent, 1.0)

    @property
    def count(self) -> int:
        """Number of cells."""
        return int(self.variants.shape[0])

    def locate(self, task: FloatArray) -> int:
        """Return the cell that a task lies in, or that of the nearest variant."""
        inside = ((self.lower <= task) & (task <= self.upper)).all(axis=1)
        if inside.any():
            return int(inside.argmax())
        return int(np.square((self.variants - task) / self._extent).sum(axis=1).argmin())

    def distribution(self, weights: FloatArray) -> TaskDistribution:
        """Return the distribution that gives each cell such a share, shape ``(variant,)``."""
        return TaskDistribution(
            parameters=self.parameters,
            weights=weights / weights.sum(),
            lower=self.lower,
            upper=self.upper,
        )

    def by_difficulty(self, harder: Sequence[int]) -> IntArray:
        """Return the cells from easy to hard by their parameters alone.

        Parameters
        ----------
        harder
            For each parameter 1 where larger values are harder, −1 where smaller ones are. With
            several parameters their positions within the range are added.
        """
        position = (self.variants - self.variants.min(axis=0)) / self._extent
        return np.argsort(position @ np.asarray(harder, dtype=np.float64), kind="stable")
