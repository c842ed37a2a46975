"""The space of tasks of one family: names, bounds, and the grid of variants."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.tasks.distribution import TaskDistribution


@dataclass(frozen=True, kw_only=True, eq=False)
class TaskSpace:
    """Task parameters with their ranges, and the variants on which behaviour is compared.

    Training draws from the continuous range; trials and tests use the variants.

    Attributes
    ----------
    parameters
        Names that end in their unit, for example ``("gravity_mps2", "wind_power")``.
    lower, upper
        Range of each parameter, shape ``(parameter,)``.
    variants
        In ascending order, shape ``(variant, parameter)``; within the range.
    harder
        For each parameter 1 where larger values are harder and −1 where smaller ones are; ``None``
        where nobody knows. Only teachers that order tasks by their parameters use it.

    Raises
    ------
    InputError
        If shapes do not fit, a value is not finite, or a variant lies outside the range.
    """

    parameters: tuple[str, ...]
    lower: FloatArray
    upper: FloatArray
    variants: FloatArray
    harder: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        problem = _problem(self)
        if problem is not None:
            raise InputError(f"The task space {problem[0]}.", remedy=problem[1])

    @classmethod
    def grid(cls, *, harder: Mapping[str, int] | None = None, **values: Sequence[float]) -> Self:
        """Return the space of all combinations of the given values.

        Parameters
        ----------
        harder
            Direction of difficulty by name, for every parameter or none.
        **values
            By parameter, the values to compare, for example
            ``TaskSpace.grid(slope_deg=range(0, 31, 5))``; the range ends at the outermost.
        """
        axes = {name: sorted(float(value) for value in axis) for name, axis in values.items()}
        if not axes or not all(axes.values()):
            raise InputError(
                "The task space has a parameter without values, or no parameter.",
                remedy="Give the values to compare, for example TaskSpace.grid(slope_deg=[0, 10]).",
            )
        if harder is not None and harder.keys() != axes.keys():
            raise InputError(
                f"`harder` names {sorted(harder)}, but the parameters are {sorted(axes)}.",
                remedy="Give 1 or -1 for each parameter, or leave `harder` out.",
            )
        return cls(
            parameters=tuple(axes),
            lower=np.array([axis[0] for axis in axes.values()]),
            upper=np.array([axis[-1] for axis in axes.values()]),
            variants=np.array(list(itertools.product(*axes.values()))),
            harder=None if harder is None else tuple(int(harder[name]) for name in axes),
        )

    @property
    def whole_range(self) -> TaskDistribution:
        """Uniform over the range."""
        return TaskDistribution.uniform(self.parameters, self.lower, self.upper)

    def named(self, task: FloatArray) -> dict[str, float]:
        """Return a task by the names of its parameters."""
        return dict(zip(self.parameters, np.asarray(task, dtype=float).tolist(), strict=True))


def _problem(space: TaskSpace) -> tuple[str, str] | None:
    count = len(space.parameters)
    if count == 0 or len(set(space.parameters)) < count:
        return "has no parameter, or one twice", "Name each parameter once."
    if space.lower.shape != (count,) or space.upper.shape != (count,):
        return "has bounds that do not fit its parameters", "Give one bound per parameter."
    if space.variants.ndim != 2 or space.variants.shape[1] != count or not len(space.variants):
        return "has variants that do not fit its parameters", "Give one column per parameter."
    if not all(np.isfinite(part).all() for part in (space.lower, space.upper, space.variants)):
        return "holds NaN or infinite values", "Give finite numbers."
    if len(np.unique(space.variants, axis=0)) < len(space.variants):
        return "names a variant twice", "Name each variant once."
    outside = (space.variants < space.lower).any() or (space.variants > space.upper).any()
    if outside or (space.lower > space.upper).any():
        return "has variants outside its bounds", "Widen the bounds, or leave the variants out."
    if space.harder is not None and (
        len(space.harder) != count or any(abs(sign) != 1 for sign in space.harder)
    ):
        return "has directions of difficulty that are not 1 or -1", "Give one per parameter."
    return None


def harder_by_success(variants: FloatArray, success_rate: FloatArray) -> tuple[int, ...]:
    """Return the direction in which success falls along each parameter.

    By the sign of the covariance of values and success; 1 where success does not depend on it.

    Parameters
    ----------
    variants, success_rate
        Shapes ``(variant, parameter)`` and ``(variant,)``.
    """
    centred = variants - variants.mean(axis=0)
    slopes = centred.T @ (success_rate - success_rate.mean())
    return tuple(-1 if math.copysign(1.0, slope) > 0 and slope != 0 else 1 for slope in slopes)
