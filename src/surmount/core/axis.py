"""How the values of a task parameter lie: the one type that knows kinds of axes.

A task is a row of numbers, whatever its parameters are: a whole number is stored as it is, a
category as its place in :attr:`Axis.names`. Every axis is *even* on a scale of its own: a
continuous one on its values, a logarithmic one on their logarithms, whole numbers and categories
each take the unit from half below to half above. What is drawn, cut into cells or compared goes
through that scale, so that nobody who uses an axis asks of which kind it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from dataclasses import dataclass
from typing import Any, Literal, Self, cast, get_args

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.errors import InputError
from surmount.core.names import is_printable

AxisKind = Literal["continuous", "logarithmic", "integer", "categorical"]
Value = float | int | str
"""A task parameter as an environment gets it."""
_DECIMALS = 9
"""Of places on the scale of whole numbers: what differs by rounding alone is equal."""
_MOST = 2**53
"""Whole numbers beyond are not exact."""


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One axis of a space of tasks.

    Attributes
    ----------
    kind
        ``"continuous"``; ``"logarithmic"``: continuous, positive and even in its logarithm;
        ``"integer"``: whole numbers; ``"categorical"``: names without distances.
    names
        The categories, in an order that only teachers which order tasks by their parameters
        look at; empty for the other kinds.

    Raises
    ------
    InputError
        If there is no such kind, or names do not fit it.
    """

    kind: AxisKind = "continuous"
    names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in get_args(AxisKind):
            raise InputError(
                f"There is no kind of axis {self.kind!r}.",
                remedy=f"Choose among {', '.join(get_args(AxisKind))}.",
            )
        if bool(self.names) != self.categorical or len(set(self.names)) < len(self.names):
            raise InputError(
                f"The axis is {self.kind} and has the names {list(self.names)}.",
                remedy="Give each category one name, and no names to axes of numbers.",
            )
        if not all(name.strip() and is_printable(name) for name in self.names):
            raise InputError(
                "A category has no name, or one that cannot be printed.",
                remedy="Give it a short name of letters and digits.",
            )

    @property
    def categorical(self) -> bool:
        """Whether it has categories, which have no distances."""
        return self.kind == "categorical"

    @property
    def discrete(self) -> bool:
        """Whether nothing lies between two neighbouring values."""
        return self.kind in ("integer", "categorical")

    # --- the scale, and the unit coordinate on it -------------------------------------------------

    def sides(self, lower: FloatArray, upper: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return where ranges of values begin and end on the scale, shapes as given."""
        half = 0.5 if self.discrete else 0.0
        return self.scale(lower) - half, self.scale(upper) + half

    def place(self, values: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
        """Return the unit coordinates of values within ranges: 0 at the lower end, 1 at the upper.

        A whole number or a category has the middle of the unit that it takes.
        """
        low, high = self.sides(lower, upper)
        return (self.scale(values) - low) / np.where(high > low, high - low, 1.0)

    def at(self, place: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
        """Return the values at unit coordinates within ranges; the reverse of :meth:`place`.

        Uniform coordinates give values that are even on the scale: every whole number and every
        category of a range with the same probability.
        """
        if self.kind == "continuous":
            return lower + place * (upper - lower)
        low, high = self.sides(lower, upper)
        scaled = low + place * (high - low)
        values = np.floor(scaled + 0.5) if self.discrete else np.exp(scaled)
        return np.clip(values, lower, upper)

    # --- what lies between the values that are compared -------------------------------------------

    def cells(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return bounds of the cell of each value, half-way to its neighbours on the scale.

        Parameters
        ----------
        values
            Distinct, in ascending order, shape ``(value,)``.

        Returns
        -------
        tuple
            Lower and upper bounds, ``(value,)``: cells tile the range between the outermost
            values, but a category is a cell by itself.
        """
        if self.categorical:
            return values, values
        scaled = self.scale(values)
        below, above = self._split(0.5 * (scaled[1:] + scaled[:-1]))
        return np.concatenate([values[:1], above]), np.concatenate([below, values[-1:]])

    def around(self, values: FloatArray, reach: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return bounds so far from values on the scale; a category has no width.

        Shapes are as given.
        """
        if self.categorical:
            return values, values
        scaled = self.scale(values)
        return self._split(scaled - reach)[1], self._split(scaled + reach)[0]

    def apart(self, first: FloatArray, second: FloatArray, extent: float) -> FloatArray:
        """Return how far values lie apart, in units of :meth:`extent`; two categories, one unit."""
        if self.categorical:
            return np.asarray(first != second, dtype=np.float64)
        return np.abs(self.scale(first) - self.scale(second)) / extent

    def extent(self, values: FloatArray) -> float:
        """Return the distance of the outermost values on the scale; 1 where they are one."""
        span = float(np.ptp(self.scale(values)))
        return span if span > 0 else 1.0

    def rank(self, values: FloatArray) -> FloatArray:
        """Return where values lie from the least, 0, to the largest, 1, shape ``(value,)``.

        Categories are ranked in the order of their names.
        """
        scaled = self.scale(values)
        return (scaled - scaled.min()) / self.extent(values)

    @property
    def observed_size(self) -> int:
        """Numbers that :meth:`observed` gives."""
        return max(len(self.names), 1)

    def observed(self, value: float, lower: float, upper: float) -> list[float]:
        """Return a value as a network can read it, from −1 to 1 within the range.

        A category has one number for each name: 1 for its own, −1 for all others.
        """
        if self.categorical:
            return [1.0 if place == round(value) else -1.0 for place in range(len(self.names))]
        low, here, high = self.scale(np.array([lower, value, upper], dtype=np.float64)).tolist()
        return [2.0 * (here - low) / (high - low if high > low else 1.0) - 1.0]

    def scale(self, values: FloatArray) -> FloatArray:
        """Return where values lie on the scale on which the axis is even, shape as given."""
        return np.log(values) if self.kind == "logarithmic" else values

    def _split(self, scaled: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the last value below a place on the scale, and the first from there on."""
        if self.discrete:
            first = np.ceil(np.round(scaled, _DECIMALS))
            return first - 1.0, first
        values = np.exp(scaled) if self.kind == "logarithmic" else scaled
        return values, values

    # --- as people and environments have it -------------------------------------------------------

    def value(self, stored: float) -> Value:
        """Return what an environment gets: a float, an int, or a category's name."""
        if self.categorical:
            return self.names[round(stored)]
        return round(stored) if self.kind == "integer" else float(stored)

    def text(self, stored: float) -> str:
        """Return a value for people."""
        value = self.value(stored)
        return value if isinstance(value, str) else f"{value:g}"

    def stored(self, value: object) -> float:
        """Return the number that stands for a value, ``nan`` where there is none.

        Parameters
        ----------
        value
            A number, or the name of a category.
        """
        if self.categorical:
            return float(self.names.index(value)) if value in self.names else np.nan  # type: ignore[arg-type]
        is_number = isinstance(value, int | float | np.integer | np.floating)
        return float(value) if is_number and not isinstance(value, bool) else np.nan  # type: ignore[arg-type]

    def holds(self, values: FloatArray) -> BoolArray:
        """Return whether values can lie on the axis, shape as given."""
        finite = np.isfinite(values)
        if self.kind == "logarithmic":
            return np.asarray(finite & (values > 0), dtype=np.bool_)
        if self.discrete:
            within = np.abs(values) < _MOST
            if self.categorical:
                within = (values >= 0) & (values < len(self.names))
            return np.asarray(finite & within & (values == np.floor(values)), dtype=np.bool_)
        return np.asarray(finite, dtype=np.bool_)

    @property
    def demand(self) -> str:
        """What values must be, for sentences."""
        if self.categorical:
            return f"one of {', '.join(self.names)}"
        return {
            "integer": "a whole number",
            "logarithmic": "a positive number",
            "continuous": "a finite number",
        }[self.kind]

    def to_record(self) -> dict[str, Any]:
        """Return the JSON form."""
        return {"kind": self.kind, **({"names": list(self.names)} if self.names else {})}

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Self:
        """Build from the JSON form, with the checks of the constructor."""
        return cls(kind=record["kind"], names=tuple(record.get("names", ())))


CONTINUOUS = Axis()
Axes = tuple[Axis, ...]


def full_axes(axes: Axes, parameters: Sized) -> Axes:
    """Return one axis per parameter: as given, or all continuous where none are.

    Raises
    ------
    InputError
        If there are some, but not one for each parameter.
    """
    if axes and len(axes) != len(parameters):
        raise InputError(
            f"There are {len(axes)} axes for {len(parameters)} parameters.",
            remedy="Give one axis per parameter, or none where all are continuous.",
        )
    return axes or (CONTINUOUS,) * len(parameters)


def axes_to_record(axes: Axes, parameters: Sequence[str]) -> dict[str, Any]:
    """Return axes by parameter in JSON form; continuous ones, which need no words, are left out."""
    return {
        name: axis.to_record()
        for name, axis in zip(parameters, axes, strict=True)
        if axis != CONTINUOUS
    }


def axes_from_record(record: Mapping[str, Any], parameters: Sequence[str]) -> Axes:
    """Return one axis per parameter; those that the record does not name are continuous."""
    return tuple(
        Axis.from_record(record[name]) if name in record else CONTINUOUS for name in parameters
    )


def common_axes(several: Sequence[Axes], parameters: Sequence[str]) -> Axes:
    """Return axes on which what lies on any of several lies too: categories are those of all.

    Raises
    ------
    InputError
        If a parameter is of several kinds.
    """
    found: list[Axis] = []
    for name, *kinds in zip(parameters, *several, strict=False):
        if len({axis.kind for axis in kinds}) > 1:
            raise InputError(
                f"`{name}` is {' here and '.join(sorted({axis.kind for axis in kinds}))} there.",
                remedy="Join only trials of one task family, logged alike.",
            )
        names = dict.fromkeys(one for axis in kinds for one in axis.names)
        found.append(kinds[0] if len(names) == len(kinds[0].names) else
                     Axis(kind="categorical", names=tuple(names)))  # fmt: skip
    return tuple(found)


def values_of(axes: Axes, task: FloatArray) -> list[Value]:
    """Return a task, shape ``(parameter,)``, as an environment gets it."""
    return [axis.value(float(stored)) for axis, stored in zip(axes, task, strict=True)]


def variant_text(axes: Axes, task: FloatArray, separator: str = ", ") -> str:
    """Return a task, shape ``(parameter,)``, for people."""
    return separator.join(axis.text(float(stored)) for axis, stored in zip(axes, task, strict=True))


def axis_of_values(values: Sequence[object], kind: AxisKind | None = None) -> Axis:
    """Return the axis that values given by hand lie on.

    Text is a category, each of the values one; numbers that are all ``int`` are whole numbers,
    other numbers continuous.

    Parameters
    ----------
    values
        Numbers or names.
    kind
        What they are, where it is said; numbers that are said to be categories have names too.
    """
    text = any(isinstance(value, str) for value in values)
    if kind == "categorical" or (kind is None and text):
        return Axis(kind="categorical", names=tuple(dict.fromkeys(map(category_name, values))))
    if kind is None:
        whole = all(isinstance(value, int | np.integer | np.bool_) for value in values)
        kind = "integer" if whole else "continuous"
    return Axis(kind=kind)


def declared(axis: Axis, column: FloatArray, kind: AxisKind, name: str) -> tuple[Axis, FloatArray]:
    """Return the axis of another kind that stored values lie on, and what stands for them there.

    Parameters
    ----------
    axis, column
        The axis as it was, and values on it, shape ``(value,)``.
    kind
        What the axis is; numbers that are said to be categories are named as they are written.
    name
        Of the parameter, for errors.

    Raises
    ------
    InputError
        If a value cannot lie on such an axis.
    """
    distinct, which = np.unique(column, return_inverse=True)
    given = [axis.value(float(one)) for one in distinct]
    if axis.kind == "continuous" and kind == "categorical":  # 3.0 is the name of nothing
        given = [round(one) if one == np.floor(one) else one for one in distinct.tolist()]
    new = axis if kind == axis.kind else axis_of_values(given, kind)
    return new, stored_values(name, given, new)[which.reshape(-1)]


def redeclared(
    axes: Axes,
    variants: FloatArray,
    parameters: Sequence[str],
    kinds: Mapping[str, AxisKind],
    *,
    called: str = "parameter",
) -> tuple[Axes, FloatArray]:
    """Return axes of which some are of other kinds, and what stands for the variants there.

    Parameters
    ----------
    axes, variants, parameters
        As they are; ``variants`` of shape ``(variant, parameter)``.
    kinds
        By parameter; numbers that are said to be categories are named as they are written.
    called
        What errors call a parameter.

    Raises
    ------
    InputError
        If there is no such parameter, or its values cannot lie on such an axis.
    """
    unknown = sorted(kinds.keys() - set(parameters))
    if unknown:
        raise InputError(
            f"There is no {called} `{unknown[0]}`.",
            remedy=f"Choose among {', '.join(parameters)}.",
        )
    found, moved = list(axes), variants.copy()
    for place, name in enumerate(parameters):
        kind = kinds.get(name, axes[place].kind)
        if kind != axes[place].kind:
            found[place], moved[:, place] = declared(axes[place], variants[:, place], kind, name)
    return tuple(found), moved


def stored_values(name: str, given: Sequence[object], axis: Axis) -> FloatArray:
    """Return the numbers that stand for values given by hand, shape ``(value,)``.

    Raises
    ------
    InputError
        If one cannot lie on the axis.
    """
    values = np.array(
        [axis.stored(category_name(one) if axis.categorical else one) for one in given]
    )
    for stored, one in zip(values, given, strict=True):
        if not axis.holds(stored):
            raise InputError(
                f"`{name}` is {axis.kind} and cannot be {one!r}.",
                remedy=f"Let each value be {axis.demand}.",
            )
    return values


def category_name(value: object) -> str:
    """Return the name of a category that is given as text or as a number."""
    if isinstance(value, str):
        return value
    return f"{cast(float, value):.17g}" if isinstance(value, float | np.floating) else str(value)
