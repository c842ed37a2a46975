"""The range of tasks cut into one cell per variant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.axis import Axes, full_axes
from surmount.core.errors import InputError
from surmount.tasks.distribution import TaskDistribution


def cells(variants: FloatArray, axes: Axes = ()) -> tuple[FloatArray, FloatArray]:
    """Return a cell for each variant of a family with several parameters.

    Variants on a full grid get the grid's cells, half-way to the neighbours along each parameter
    and ending at the outermost values, so that the cells tile the family's range. Scattered
    variants get boxes that never overlap: along every parameter (in units of the family's range)
    half the distance to the nearest other variant, by the largest difference over parameters,
    cut at the family's range. A category is a cell by itself: there is nothing between two.

    Parameters
    ----------
    variants
        Shape ``(variant, parameter)``.
    axes
        One per parameter; all are continuous where none are given.

    Returns
    -------
    tuple
        Lower and upper bounds, each of shape ``(variant, parameter)``.
    """
    along = full_axes(axes, variants[0])
    grid = [np.unique(column) for column in variants.T]
    lower, upper = np.empty_like(variants), np.empty_like(variants)
    if variants.shape[0] == np.prod([values.size for values in grid]):
        for parameter, (axis, values) in enumerate(zip(along, grid, strict=True)):
            place = np.searchsorted(values, variants[:, parameter])
            low, high = axis.cells(values)
            lower[:, parameter], upper[:, parameter] = low[place], high[place]
        return lower, upper
    distance = differences(variants, along).max(axis=2)
    np.fill_diagonal(distance, np.inf)
    nearest = 0.5 * distance.min(axis=1)
    for parameter, axis in enumerate(along):
        values = variants[:, parameter]
        low, high = axis.around(values, nearest * axis.extent(values))
        lower[:, parameter] = np.maximum(low, values.min())
        upper[:, parameter] = np.minimum(high, values.max())
    return lower, upper


def differences(variants: FloatArray, axes: Axes) -> FloatArray:
    """Return how far each two variants lie apart along each parameter, in units of its range.

    Two categories are one unit apart.

    Returns
    -------
    FloatArray
        Shape ``(variant, variant, parameter)``.
    """
    columns = zip(axes, variants.T, strict=True)
    return np.stack(
        [axis.apart(one[:, None], one[None, :], axis.extent(one)) for axis, one in columns], axis=2
    )


class TaskCells:
    """One cell per variant, half-way to its neighbours.

    Training draws from the whole range; a teacher that chooses among variants chooses a cell, and
    the environment draws uniformly within it.

    Parameters
    ----------
    parameters
        Names of the task parameters.
    variants
        Shape ``(variant, parameter)``.
    axes
        One per parameter; all are continuous where none are given.

    Attributes
    ----------
    parameters, variants, axes
        As given.
    lower, upper
        Bounds of the cells, shape ``(variant, parameter)``.
    """

    def __init__(self, parameters: tuple[str, ...], variants: FloatArray, axes: Axes = ()) -> None:
        self.parameters = parameters
        self.axes = full_axes(axes, parameters)
        self.variants = np.asarray(variants, dtype=np.float64).reshape(-1, len(parameters))
        if self.variants.shape[0] == 0:
            raise InputError("There are no variants.", remedy="Give at least one.")
        self.lower, self.upper = cells(self.variants, self.axes)

    @property
    def count(self) -> int:
        """Number of cells."""
        return int(self.variants.shape[0])

    def locate(self, task: FloatArray) -> int:
        """Return the cell that a task lies in, or that of the nearest variant."""
        inside = ((self.lower <= task) & (task <= self.upper)).all(axis=1)
        if inside.any():
            return int(inside.argmax())
        away = [
            axis.apart(values, place, axis.extent(values))
            for axis, values, place in zip(self.axes, self.variants.T, task, strict=True)
        ]
        return int(np.square(away).sum(axis=0).argmin())

    def distribution(self, weights: FloatArray) -> TaskDistribution:
        """Return the distribution that gives each cell such a share, shape ``(variant,)``."""
        return TaskDistribution(
            parameters=self.parameters,
            weights=weights / weights.sum(),
            lower=self.lower,
            upper=self.upper,
            axes=self.axes,
        )

    def by_difficulty(self, harder: Sequence[int]) -> IntArray:
        """Return the cells from easy to hard by their parameters alone.

        Parameters
        ----------
        harder
            For each parameter 1 where larger values, or later categories, are harder, −1 where
            smaller ones are. With several parameters their positions within the range are added.
        """
        position = positions(self.variants, self.axes)
        return np.argsort(position @ np.asarray(harder, dtype=np.float64), kind="stable")


def positions(variants: FloatArray, axes: Axes) -> FloatArray:
    """Return where variants lie along each axis, from 0 at the least to 1 at the largest.

    Returns
    -------
    FloatArray
        Shape ``(variant, parameter)``.
    """
    return np.stack([axis.rank(values) for axis, values in zip(axes, variants.T, strict=True)], 1)
