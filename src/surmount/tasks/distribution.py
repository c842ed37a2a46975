"""Distributions over tasks: what a teacher pushes to environments, which then draw from it.

Pushing a *distribution* instead of single tasks needs no queue between teacher and environments
and survives automatic resets of vector environments, which drop ``reset(options=...)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NotRequired, Self, TypedDict

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.axis import Axes, axes_from_record, axes_to_record, full_axes
from surmount.core.errors import InputError


class TaskDistributionRecord(TypedDict):
    """JSON form of a :class:`TaskDistribution`."""

    parameters: list[str]
    weights: list[float]
    lower: list[list[float]]
    upper: list[list[float]]
    axes: NotRequired[dict[str, Any]]


@dataclass(frozen=True, kw_only=True, eq=False)
class TaskDistribution:
    """A weighted mixture of uniform boxes in the space of task parameters.

    This is the level mixture of the paper (eq. 4), ``P = Σᵢ wᵢ U(LBᵢ, UBᵢ)``, for any number of
    parameters. A box of zero width along a parameter stands for a single value of it. ``U`` is
    uniform on the scale of each axis: in the logarithm on a logarithmic one, over the whole numbers
    or the categories from the lower to the upper bound.

    Attributes
    ----------
    parameters
        Names of the task parameters, in the order of the last axis of the bounds.
    weights
        Probability of each box, shape ``(box,)``; non-negative, summing to 1.
    lower, upper
        Bounds of each box in the parameters' units, shape ``(box, parameter)``; a category is
        its place among the names of its axis.
    axes
        One for each parameter; all are continuous where none are given.
    """

    parameters: tuple[str, ...]
    weights: FloatArray
    lower: FloatArray
    upper: FloatArray
    axes: Axes = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "axes", full_axes(self.axes, self.parameters))
        boxes, n_parameters = self.weights.size, len(self.parameters)
        if self.weights.ndim != 1 or boxes == 0:
            raise InputError(
                f"A task distribution needs a list of box weights, not shape {self.weights.shape}.",
                remedy="Give one weight per box.",
            )
        for name, bound in (("lower", self.lower), ("upper", self.upper)):
            if bound.shape != (boxes, n_parameters):
                raise InputError(
                    f"The {name} bounds have shape {bound.shape}, expected "
                    f"{(boxes, n_parameters)} for {boxes} boxes and {n_parameters} parameters.",
                    remedy="Give one bound per box and parameter.",
                )
        values = np.concatenate([self.weights, self.lower.ravel(), self.upper.ravel()])
        if not np.isfinite(values).all():
            raise InputError(
                "A task distribution holds NaN or infinite values.",
                remedy="Give finite weights and bounds.",
            )
        if (self.weights < 0).any() or abs(float(self.weights.sum()) - 1.0) > 1e-9:
            raise InputError(
                f"Box weights must be non-negative and sum to 1, not {self.weights.tolist()}.",
                remedy="Divide the weights by their sum.",
            )
        if (self.lower > self.upper).any():
            raise InputError(
                "A lower bound exceeds its upper bound.", remedy="Swap the two bounds of that box."
            )
        for axis, name, bounds in zip(
            self.axes, self.parameters, np.concatenate([self.lower, self.upper]).T, strict=True
        ):
            if not axis.holds(bounds).all():
                raise InputError(
                    f"A bound of `{name}` is {bounds[~axis.holds(bounds)][0]:g}.",
                    remedy=f"Let each be {axis.demand}.",
                )

    @classmethod
    def uniform(
        cls,
        parameters: tuple[str, ...],
        lower: FloatArray,
        upper: FloatArray,
        axes: Axes = (),
    ) -> TaskDistribution:
        """Return the uniform distribution over one box, bounds of shape ``(parameter,)``."""
        return cls(
            parameters=parameters,
            weights=np.ones(1),
            lower=np.atleast_2d(np.asarray(lower, dtype=np.float64)),
            upper=np.atleast_2d(np.asarray(upper, dtype=np.float64)),
            axes=axes,
        )

    def sample(self, rng: np.random.Generator, size: int) -> FloatArray:
        """Draw tasks.

        Parameters
        ----------
        rng
            Source of randomness; two draws per task and parameter are not shared between tasks,
            so drawing one by one or all at once gives equally distributed tasks.
        size
            Number of tasks.

        Returns
        -------
        FloatArray
            Tasks in the parameters' units, shape ``(size, parameter)``.
        """
        box = rng.choice(self.weights.size, size=size, p=self.weights)
        position = rng.random((size, len(self.parameters)))
        lower, upper = self.lower[box], self.upper[box]
        columns = [
            axis.at(position[:, k], lower[:, k], upper[:, k]) for k, axis in enumerate(self.axes)
        ]
        return np.stack(columns, axis=1)

    def to_record(self) -> TaskDistributionRecord:
        """Return the JSON form."""
        record: TaskDistributionRecord = {
            "parameters": list(self.parameters),
            "weights": self.weights.tolist(),
            "lower": self.lower.tolist(),
            "upper": self.upper.tolist(),
        }
        axes = axes_to_record(self.axes, self.parameters)
        return {**record, "axes": axes} if axes else record

    @classmethod
    def from_record(cls, record: TaskDistributionRecord) -> Self:
        """Build from the JSON form, with the checks of the constructor."""
        return cls(
            parameters=tuple(record["parameters"]),
            weights=np.asarray(record["weights"], dtype=np.float64),
            lower=np.asarray(record["lower"], dtype=np.float64),
            upper=np.asarray(record["upper"], dtype=np.float64),
            axes=axes_from_record(record.get("axes", {}), record["parameters"]),
        )
