"""The range of tasks as a unit box, for methods that compute with distances between tasks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.axis import Axes, Axis
from surmount.core.errors import ConfigError
from surmount.tasks.distribution import TaskDistribution


def require_distances(axes: Axes, parameters: tuple[str, ...], method: str) -> None:
    """Refuse categories, between which there are no distances.

    Parameters
    ----------
    axes, parameters
        Of the space of tasks.
    method
        What needs distances, as the subject of a sentence.

    Raises
    ------
    ConfigError
        If a parameter is categorical.
    """
    named = [name for name, axis in zip(parameters, axes, strict=True) if axis.categorical]
    if named:
        raise ConfigError(
            f"{method} needs distances between tasks, and `{named[0]}` has categories, which have "
            "none.",
            remedy="Choose a teacher that chooses among variants, such as plr, learning-progress "
            "or learnability, or the paper's levels.",
        )


class UnitBox:
    """Maps tasks within a range to coordinates from 0 to 1, on the scale of each axis, and back.

    Parameters
    ----------
    whole_range
        Distribution over the whole range.

    Attributes
    ----------
    size
        Number of parameters.
    extent
        Length of the range on the scale of each axis, ``(parameter,)``.
    """

    def __init__(self, whole_range: TaskDistribution) -> None:
        self._axes = whole_range.axes
        self._lower = whole_range.lower.min(axis=0)
        self._upper = whole_range.upper.max(axis=0)
        self.size = self._lower.size
        low, high = box_sides(self._axes, self._lower[None], self._upper[None])
        self._low, self.extent = low[0], np.where(high > low, high - low, 1.0)[0]

    def places(self, tasks: FloatArray) -> FloatArray:
        """Return the coordinates of tasks, shapes ``(task, parameter)``."""
        return self._moved(Axis.place, tasks)

    def tasks(self, places: FloatArray) -> FloatArray:
        """Return the tasks at coordinates, shapes ``(task, parameter)``."""
        return self._moved(Axis.at, places)

    def sides(self, distribution: TaskDistribution) -> tuple[FloatArray, FloatArray]:
        """Return the bounds of a distribution's boxes, each of shape ``(box, parameter)``."""
        lower, upper = box_sides(self._axes, distribution.lower, distribution.upper)
        return (lower - self._low) / self.extent, (upper - self._low) / self.extent

    def _moved(
        self,
        move: Callable[[Axis, FloatArray, FloatArray, FloatArray], FloatArray],
        rows: FloatArray,
    ) -> FloatArray:
        """Return rows with each column moved along its axis."""
        ends = zip(self._axes, rows.T, self._lower, self._upper, strict=True)
        return np.stack([move(axis, column, low, high) for axis, column, low, high in ends], axis=1)


def box_sides(axes: Axes, lower: FloatArray, upper: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return bounds of boxes on the scales of their axes, each of shape ``(box, parameter)``."""
    sides = [axis.sides(lower[:, k], upper[:, k]) for k, axis in enumerate(axes)]
    low, high = zip(*sides, strict=True)
    return np.stack(low, axis=1), np.stack(high, axis=1)
