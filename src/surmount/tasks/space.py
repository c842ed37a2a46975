"""The space of tasks of one family: names, bounds, and the grid of variants."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Self

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.axis import (
    Axes,
    AxisKind,
    Value,
    axis_of_values,
    full_axes,
    redeclared,
    stored_values,
    values_of,
    variant_text,
)
from surmount.core.errors import InputError
from surmount.tasks.cells import positions
from surmount.tasks.distribution import TaskDistribution

NO_KINDS: Mapping[str, AxisKind] = MappingProxyType({})


@dataclass(frozen=True, kw_only=True, eq=False)
class TaskSpace:
    """Task parameters with their ranges, and the variants on which behaviour is compared.

    Training draws from the whole range; trials and tests use the variants. A task is a row of
    numbers in which a category is its place among the names of its axis; :meth:`named` gives it as
    environments get it.

    Attributes
    ----------
    parameters
        Names that end in their unit, for example ``("gravity_mps2", "wind_power")``.
    lower, upper
        Range of each parameter, shape ``(parameter,)``.
    variants
        In ascending order, shape ``(variant, parameter)``; within the range.
    harder
        For each parameter 1 where larger values, or later categories, are harder and −1 where
        smaller ones are; ``None`` where nobody knows. Only teachers that order tasks by their
        parameters use it.
    axes
        One for each parameter; all are continuous where none are given.

    Raises
    ------
    InputError
        If shapes do not fit, a value cannot lie on its axis, or a variant lies outside the range.
    """

    parameters: tuple[str, ...]
    lower: FloatArray
    upper: FloatArray
    variants: FloatArray
    harder: tuple[int, ...] | None = None
    axes: Axes = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "axes", full_axes(self.axes, self.parameters))
        problem = _problem(self)
        if problem is not None:
            raise InputError(f"The task space {problem[0]}.", remedy=problem[1])

    @classmethod
    def grid(
        cls,
        *,
        harder: Mapping[str, int] | None = None,
        axes: Mapping[str, AxisKind] = NO_KINDS,
        **values: Sequence[float] | Sequence[str],
    ) -> Self:
        """Return the space of all combinations of the given values.

        Names are categories, numbers that are all ``int`` whole numbers, other numbers continuous
        (docs/adr/0085).

        Parameters
        ----------
        harder
            Direction of difficulty by name, for every parameter or none; categories are taken in
            the order in which they are given.
        axes
            By parameter, the kind of its axis where its values do not tell: ``"logarithmic"``,
            or another than they tell.
        **values
            By parameter, the values to compare, for example
            ``TaskSpace.grid(slope_deg=np.linspace(0, 30, 7), terrain=["flat", "stairs"])``; the
            range ends at the outermost.
        """
        given = {name: list(column) for name, column in values.items()}
        if not given or not all(given.values()):
            raise InputError(
                "The task space has a parameter without values, or no parameter.",
                remedy="Give the values to compare, for example TaskSpace.grid(slope_deg=[0, 10]).",
            )
        for what, named in (("harder", harder), ("axes", axes)):
            unknown = set(named or ()) - given.keys()
            if unknown or (what == "harder" and named is not None and named.keys() != given.keys()):
                raise InputError(
                    f"`{what}` names {sorted(named or ())}, but the parameters are "
                    f"{sorted(given)}.",
                    remedy="Give 1 or -1 for each parameter, or leave `harder` out."
                    if what == "harder"
                    else "Name parameters of the space.",
                )
        found = {name: axis_of_values(column, axes.get(name)) for name, column in given.items()}
        grid = [np.sort(stored_values(name, given[name], axis)) for name, axis in found.items()]
        return cls(
            parameters=tuple(found),
            lower=np.array([column[0] for column in grid]),
            upper=np.array([column[-1] for column in grid]),
            variants=np.array(list(itertools.product(*grid))),
            harder=None if harder is None else tuple(int(harder[name]) for name in found),
            axes=tuple(found.values()),
        )

    def declared(self, kinds: Mapping[str, AxisKind]) -> TaskSpace:
        """Return the same space with parameters of other kinds.

        Parameters
        ----------
        kinds
            By parameter; numbers that are said to be categories are named as they are written.

        Raises
        ------
        InputError
            If there is no such parameter, or its values cannot lie on such an axis.
        """
        axes, variants = redeclared(self.axes, self.variants, self.parameters, kinds)
        lower, upper = self.lower.copy(), self.upper.copy()
        for place, (before, axis) in enumerate(zip(self.axes, axes, strict=True)):
            if axis.categorical and axis != before:
                lower[place], upper[place] = 0.0, len(axis.names) - 1.0
        return replace(self, lower=lower, upper=upper, variants=variants, axes=axes)

    @property
    def whole_range(self) -> TaskDistribution:
        """Uniform over the range, on the scale of each axis."""
        return TaskDistribution.uniform(self.parameters, self.lower, self.upper, self.axes)

    def require_same(self, distribution: TaskDistribution) -> None:
        """Refuse a distribution that no environment over this space can draw from.

        Raises
        ------
        InputError
            If it is over other parameters, or other axes.
        """
        if tuple(distribution.parameters) != self.parameters:
            raise InputError(
                f"The distribution is over {', '.join(distribution.parameters)}, the environment "
                f"over {', '.join(self.parameters)}.",
                remedy="Use a curriculum that was made for this environment.",
            )
        if distribution.axes != self.axes:
            raise InputError(
                f"The distribution is over axes that are {_kinds(distribution.axes)}, those of the "
                f"environment are {_kinds(self.axes)}.",
                remedy="Give the environment's: `curriculum.on(env.space.axes)`, or "
                "TaskDistribution(…, axes=env.space.axes).",
            )

    def named(self, task: FloatArray) -> dict[str, Value]:
        """Return a task by the names of its parameters, as environments get it.

        A whole number is an ``int``, a category its name, everything else a ``float``.
        """
        return dict(zip(self.parameters, values_of(self.axes, np.asarray(task)), strict=True))

    def task(self, values: Sequence[object]) -> FloatArray:
        """Return a task, shape ``(parameter,)``, from one value for each parameter.

        Parameters
        ----------
        values
            Numbers, or text that is one, and categories by their names or by their places among
            them.

        Raises
        ------
        InputError
            If a value cannot lie on its axis.
        """
        if len(values) != len(self.parameters):
            raise InputError(
                f"The variant {list(values)} does not fit {', '.join(self.parameters)}.",
                remedy="Give one value per parameter.",
            )
        task = np.array(
            [
                axis.stored(value)
                if axis.categorical and isinstance(value, str)
                else _number(value)
                for axis, value in zip(self.axes, values, strict=True)
            ]
        )
        for axis, name, stored, value in zip(self.axes, self.parameters, task, values, strict=True):
            if not axis.holds(np.asarray(stored)):
                raise InputError(
                    f"The variant has {value!r} as `{name}`.", remedy=f"Give {axis.demand}."
                )
        return task

    def text(self, task: FloatArray) -> str:
        """Return a task for people, without the names of its parameters."""
        return variant_text(self.axes, task)

    def described(self, task: FloatArray) -> str:
        """Return a task for people, each value with the name of its parameter."""
        values = zip(self.parameters, self.axes, task.tolist(), strict=True)
        return ", ".join(f"{name}={axis.text(stored)}" for name, axis, stored in values)


def describe_range(space: TaskSpace, index: int) -> str:
    """Return a parameter with its range and what it is, for people."""
    axis, low, high = space.axes[index], space.lower[index], space.upper[index]
    name = space.parameters[index]
    if axis.categorical:
        return f"{name}: one of {', '.join(axis.names)}"
    words = {"integer": ", whole numbers", "logarithmic": ", logarithmic"}.get(axis.kind, "")
    return f"{name}: {axis.text(low)} to {axis.text(high)}{words}"


def _number(value: object) -> float:
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return np.nan


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
    for axis, name, lower, upper, values in zip(
        space.axes, space.parameters, space.lower, space.upper, space.variants.T, strict=True
    ):
        if not axis.holds(np.array([lower, upper, *values])).all():
            return f"has a value of `{name}` that is not {axis.demand}", "Correct it."
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


def harder_by_success(
    variants: FloatArray, success_rate: FloatArray, axes: Axes = ()
) -> tuple[int, ...]:
    """Return the direction in which success falls along each parameter.

    By the sign of the covariance of places along the axis and success; 1 where success does not
    depend on it.

    Parameters
    ----------
    variants, success_rate
        Shapes ``(variant, parameter)`` and ``(variant,)``.
    axes
        One per parameter; all are continuous where none are given.
    """
    places = positions(variants, full_axes(axes, variants[0]))
    slopes = (places - places.mean(axis=0)).T @ (success_rate - success_rate.mean())
    return tuple(-1 if math.copysign(1.0, slope) > 0 and slope != 0 else 1 for slope in slopes)


def _kinds(axes: Axes) -> str:
    return " and ".join(
        f"{axis.kind} ({', '.join(axis.names)})" if axis.names else axis.kind for axis in axes
    )
