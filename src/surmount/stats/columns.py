"""Columns given by a user, checked: numbers, yes/no flags, labels, counts and confidence levels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.errors import InputError

ROUNDING = 64 * float(np.finfo(np.float64).eps)
"""A spread below this share of the largest number involved is none but for rounding."""

LARGEST = 1e100
"""Numbers beyond this are refused: their squares could not be added up."""


class Table(Protocol):
    """Columns by name: a mapping of sequences or arrays, or a Polars or pandas data frame."""

    def __contains__(self, key: str, /) -> bool:
        """Return whether there is a column of that name."""
        ...

    def __getitem__(self, key: str, /) -> object:
        """Return a column."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class Labels:
    """A column of labels.

    Attributes
    ----------
    names
        Distinct labels: numbers ascending, or words in alphabetical order.
    codes
        Index of each row's label into ``names``, shape ``(row,)``.
    """

    names: tuple[str, ...]
    codes: IntArray


def column(table: Table, name: str) -> object:
    """Return a column of a table by its name."""
    if name not in table:
        raise InputError(
            f"The table has no column `{name}`.", remedy="Name one of the table's columns."
        )
    return table[name]


def _one_dimensional(values: object, name: str) -> np.ndarray:
    try:
        array = np.asarray(values)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"`{name}` cannot be read as a column ({error}).", remedy="Give one value per row."
        ) from error
    if array.ndim != 1:
        raise InputError(
            f"`{name}` has shape {array.shape}, expected one dimension.",
            remedy="Give one value per row.",
        )
    if array.size == 0:
        raise InputError(f"`{name}` is empty.", remedy="Give at least one row.")
    return array


def numbers(values: object, name: str) -> FloatArray:
    """Return finite numbers, shape ``(row,)``."""
    array = _one_dimensional(values, name)
    if array.dtype.kind not in "biufO":
        raise InputError(
            f"`{name}` holds values of type {array.dtype}, which are not real numbers.",
            remedy="Convert them to numbers first.",
        )
    try:
        result = array.astype(np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(
            f"`{name}` holds values that are not numbers ({error}).", remedy="Give real numbers."
        ) from error
    bad = np.flatnonzero(~np.isfinite(result))
    if bad.size:
        raise InputError(
            f"`{name}` is NaN, infinite or missing in {bad.size} of {result.size} rows, "
            f"first in row {bad[0]}.",
            remedy="Drop those rows, or give them a value.",
        )
    if np.abs(result).max() > LARGEST:
        raise InputError(
            f"`{name}` holds the number {result[np.abs(result).argmax()]:g}, whose square is out "
            "of range.",
            remedy="Give it in a larger unit.",
        )
    return result


def flags(values: object, name: str) -> BoolArray:
    """Return yes/no values given as booleans or as 0 and 1, shape ``(row,)``."""
    array = numbers(values, name)
    bad = array[(array != 0) & (array != 1)]
    if bad.size:
        raise InputError(
            f"`{name}` holds {bad[0]:g}, which is neither true nor false.",
            remedy="Give booleans, or 1 for an event and 0 for a censored row.",
        )
    return array == 1


def times(values: object, name: str) -> FloatArray:
    """Return non-negative finite times, shape ``(row,)``."""
    array = numbers(values, name)
    if (array < 0).any():
        raise InputError(
            f"`{name}` holds the negative time {array.min():g}.",
            remedy="Measure time from the start of each trial.",
        )
    return array


def _is_missing(label: object) -> bool:
    if isinstance(label, float):
        return math.isnan(label)
    return label is None or type(label).__name__ == "NAType"  # pandas.NA compares to nothing


def labels(values: object, name: str, *, order: Sequence[object] | None = None) -> Labels:
    """Return a column of labels, in their natural order or in the one given.

    Parameters
    ----------
    values
        One label per row.
    name
        Name of the column, for messages.
    order
        All labels in the order wanted; those without a row are kept.
    """
    rows: list[object] = _one_dimensional(values, name).tolist()
    missing = [index for index, row in enumerate(rows) if _is_missing(row)]
    if missing:
        raise InputError(
            f"`{name}` has no label in {len(missing)} of {len(rows)} rows, first in row "
            f"{missing[0]}.",
            remedy="Drop those rows, or label them.",
        )
    if order is None:
        distinct = {str(row): row for row in rows}
        numeric = all(
            isinstance(row, int | float) and not isinstance(row, bool) for row in distinct.values()
        )
        names = sorted(distinct, key=lambda text: (float(text) if numeric else 0.0, text))
    else:
        names = [str(label) for label in order]
        if len(set(names)) != len(names):
            raise InputError(
                f"The order of `{name}` names a label twice: {', '.join(names)}.",
                remedy="Name each label once.",
            )
    index = {text: position for position, text in enumerate(names)}
    unknown = sorted({str(row) for row in rows} - set(index))
    if unknown:
        raise InputError(
            f"`{name}` holds `{unknown[0]}`, which its order {', '.join(names)} does not name.",
            remedy="Name every label of the column in the order, or leave the order out.",
        )
    return Labels(
        names=tuple(names), codes=np.array([index[str(row)] for row in rows], dtype=np.int64)
    )


def counts(values: object, name: str) -> IntArray:
    """Return non-negative whole numbers, shape ``(row,)``."""
    array = numbers(values, name)
    if (array < 0).any() or (array != np.floor(array)).any() or (array > 2**53).any():
        raise InputError(
            f"`{name}` must hold counts, not {array.tolist()}.",
            remedy="Give non-negative whole numbers.",
        )
    return array.astype(np.int64)


def require_same_length(**columns: Sequence[object] | np.ndarray) -> None:
    """Raise unless all columns have the same number of rows."""
    lengths = {name: len(values) for name, values in columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"`{name}` {length}" for name, length in lengths.items())
        raise InputError(
            f"The columns differ in length: {listed}.", remedy="Give one value per row in each."
        )


def require_confidence(confidence: float) -> None:
    """Raise unless a confidence level lies strictly between 0 and 1."""
    if not 0.0 < confidence < 1.0:
        raise InputError(
            f"The confidence level is {confidence:g}, which is not between 0 and 1.",
            remedy="Give a fraction such as 0.95.",
        )
