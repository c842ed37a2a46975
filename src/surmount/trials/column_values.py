"""Entries of a table's columns as numbers and identities, whatever form they come in."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.axis import CONTINUOUS, Axis
from surmount.core.names import is_printable
from surmount.trials.coded_column import Coded, coded, row_pieces
from surmount.trials.table_problems import Problems

_LARGEST_VALUE = 1e100
"""Larger values count as infinite: their squares overflow."""
_MISSING = {"nan", "NaN", "NaT", "<NA>"}
"""How NumPy, pandas and Polars print an entry that is missing."""
_WORDS = {"true": 1.0, "false": 0.0, "yes": 1.0, "no": 0.0}


def column_array(values: Any) -> np.ndarray[Any, Any]:
    """Return a column as an array; entries that are no scalars stay objects, masked are None."""
    if isinstance(values, np.ma.MaskedArray):
        entries = np.asarray(values.data, dtype=object)
        entries[np.ma.getmaskarray(values)] = None
        return entries
    try:
        return np.asarray(values)
    except ValueError:  # lists of unequal length
        column = np.empty(len(values), dtype=object)
        column[:] = list(values)
        return column


def numbers(name: str, array: np.ndarray[Any, Any], problems: Problems) -> FloatArray:
    """Return a column as numbers, noting the rows where it is no finite one."""
    words = np.empty(0, dtype=np.int64)
    if array.dtype.kind in "biuf":
        values = array.astype(np.float64, copy=False)
    else:
        values = np.empty(array.size)
        bad = np.zeros(array.size, dtype=np.bool_)
        for rows in row_pieces(array.size):
            entries = array[rows].tolist()
            values[rows] = [_number(entry) for entry in entries]
            bad[rows] = [_is_word(entry) for entry in entries]
        words = np.flatnonzero(bad)
        problems.rows(words, f"`{name}` is not a number", f"Write numbers in `{name}`.")
        values[words] = 0.0  # told once
    problems.rows(
        rows_where(lambda x: ~(np.abs(x) <= _LARGEST_VALUE), values),
        f"`{name}` is missing, NaN or infinite",
        "Drop the trial, or log a finite value.",
    )
    if words.size:
        values[words] = np.nan
    return values


def _text(entry: object) -> str:
    """Return an entry as text, empty where it is missing."""
    text = "" if entry is None else str(entry).strip()
    return "" if text in _MISSING else text


def _number(entry: object) -> float:
    text = _text(entry).lower()
    try:
        return _WORDS[text] if text in _WORDS else float(text or "nan")
    except ValueError:
        return np.nan


def _is_word(entry: object) -> bool:
    """Return whether an entry is text that stands for no number at all."""
    text = _text(entry).lower()
    if not text or text in _WORDS:
        return False
    try:
        float(text)
    except ValueError:
        return True
    return False


def parameter(
    name: str, array: np.ndarray[Any, Any], problems: Problems
) -> tuple[FloatArray, Axis]:
    """Return a column of a task parameter and its axis: names are categories, numbers continuous.

    Categories are in alphabetical order. A column that holds both names and numbers is noted as
    one of numbers.
    """
    if array.dtype.kind not in "biuf":
        texts: dict[str, int] = {}
        code = np.empty(array.size, dtype=np.int64)
        for rows in row_pieces(array.size):
            entries = [_text(entry) for entry in array[rows].tolist()]
            code[rows] = [texts.setdefault(entry, len(texts)) for entry in entries]
        named = [text for text in texts if text]
        if named and all(map(_is_word, named)):
            if "" in texts:
                empty = np.flatnonzero(code == texts[""])
                problems.rows(empty, f"`{name}` is missing", f"Give each row a `{name}`.")
            if not all(map(is_printable, named)):
                problems.add(
                    f"a category of `{name}` has control characters or is too long",
                    "Give it a short name of letters and digits.",
                )
                return np.zeros(array.size), CONTINUOUS
            names = sorted(named)
            rank = np.array([names.index(text) if text else 0 for text in texts], dtype=np.float64)
            return rank[code], Axis(kind="categorical", names=tuple(names))
    return numbers(name, array, problems), CONTINUOUS


def labels(name: str, array: np.ndarray[Any, Any], problems: Problems) -> Coded:
    """Return a column of whole numbers or names in coded form, noting the rows where it is none."""
    n_rows = array.size
    if array.dtype.kind in "biu":
        return coded(lambda rows: array[rows].astype(np.int64), n_rows)
    if array.dtype.kind != "f":
        texts: dict[str, int] = {}
        code = np.empty(n_rows, dtype=np.int32)
        for rows in row_pieces(n_rows):
            entries = [_text(entry) for entry in array[rows].tolist()]
            code[rows] = [texts.setdefault(entry, len(texts)) for entry in entries]
        if any(_is_word(text) for text in texts):
            if "" in texts:
                empty = np.flatnonzero(code == texts[""])
                problems.rows(empty, f"`{name}` is missing", f"Give each row a `{name}`.")
            rank = np.unique(list(texts), return_inverse=True)[1].astype(np.int32)
            return Coded(distinct=np.arange(rank.size), code=rank[code])
    values = numbers(name, array, problems)
    broken = rows_where(lambda x: np.isfinite(x) & ~_whole(x), values)
    problems.rows(broken, f"`{name}` is not a whole number", f"Number each `{name}` from 0.")
    return coded(
        lambda rows: np.where(_whole(values[rows]), values[rows], 0.0).astype(np.int64), n_rows
    )


def _whole(values: FloatArray) -> BoolArray:
    finite = np.isfinite(values) & (np.abs(values) < 2.0**53)
    return finite & (values == np.floor(np.where(finite, values, 0.0)))


def rows_where(condition: Callable[[FloatArray], BoolArray], values: FloatArray) -> IntArray:
    """Return the rows, ascending, whose values fulfil a condition."""
    found = [
        np.flatnonzero(condition(values[rows])) + rows.start for rows in row_pieces(values.size)
    ]
    return np.concatenate(found).astype(np.int64)
