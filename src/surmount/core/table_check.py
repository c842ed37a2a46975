"""Checks on the columns of a table of trials, all problems gathered before anything is refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import InputError

_KEYS = ("network", "trial", "success")
_LARGEST_VALUE = 1e100
"""Larger values count as infinite: their squares overflow."""
_SHOWN_ROWS = 5
_SHOWN_PROBLEMS = 20
_WORDS = {"true": 1.0, "false": 0.0, "yes": 1.0, "no": 0.0}


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """Columns of a table of trials, one entry per row.

    Attributes
    ----------
    parameters, feature_names
        Names of the task parameters and of the features.
    variant
        Shape ``(row, parameter)``.
    network, trial
        Integers, shape ``(row,)``; names are numbered in alphabetical order.
    success
        0 or 1, shape ``(row,)``.
    features
        Shape ``(row, feature)``.
    """

    parameters: tuple[str, ...]
    feature_names: tuple[str, ...]
    variant: FloatArray
    network: IntArray
    trial: IntArray
    success: FloatArray
    features: FloatArray


@dataclass
class Problems:
    """Problems found so far, each with its remedy."""

    found: list[tuple[str, str]] = field(default_factory=list[tuple[str, str]])

    def add(self, problem: str, remedy: str) -> None:
        """Note a problem."""
        self.found.append((problem, remedy))

    def rows(self, rows: IntArray, problem: str, remedy: str) -> None:
        """Note a problem of some rows, counted from 0, if there are any."""
        if rows.size:
            listed = ", ".join(str(row + 1) for row in rows[:_SHOWN_ROWS])
            more = f" and {rows.size - _SHOWN_ROWS} more" if rows.size > _SHOWN_ROWS else ""
            self.add(f"row {listed}{more}: {problem}", remedy)

    def raise_if_any(self, source: str) -> None:
        """Refuse the table with all problems at once."""
        if not self.found:
            return
        shown = [f"{problem}. {remedy}" for problem, remedy in self.found[:_SHOWN_PROBLEMS]]
        if len(self.found) > _SHOWN_PROBLEMS:
            shown.append(f"and {len(self.found) - _SHOWN_PROBLEMS} more problems.")
        if len(shown) == 1:
            raise InputError(f"{source}: {self.found[0][0]}.", remedy=self.found[0][1])
        listed = "".join(f"\n  {number}. {text}" for number, text in enumerate(shown, start=1))
        raise InputError(
            f"{source} has {len(self.found)} problems:{listed}\n",
            remedy="Correct them all and try again.",
        )


def checked_columns(table: Mapping[str, Any], problems: Problems) -> Table:
    """Return a table's columns as numbers, noting every problem of their names and values.

    Parameters
    ----------
    table
        Columns by name.
    problems
        Where problems are noted; the result is only to be used if there is none.
    """
    names = [str(name) for name in getattr(table, "columns", table)]
    single = ["variant"] if "variant" in names else []
    several = [name for name in names if name.startswith("variant.")]
    _check_names(names, single, several, problems)
    variant_columns = single or several
    features = [name for name in names if name not in {*variant_columns, *several, *_KEYS}]
    if not features:
        problems.add("there is no feature column", "Log at least one feature per control step.")
    lengths = {name: np.asarray(table[name]).shape for name in names}
    if len(set(lengths.values())) > 1 or any(len(shape) != 1 for shape in lengths.values()):
        problems.add("columns differ in length", "Give each column one entry per row.")
        return _empty()
    n_rows = next(iter(lengths.values()))[0] if lengths else 0
    if n_rows == 0:
        problems.add("the table has no rows", "Log at least one trial.")
        return _empty()

    def numbers(name: str) -> FloatArray:
        return _numbers(name, table[name], problems) if name in names else np.zeros(n_rows)

    def labels(name: str) -> IntArray:
        if name not in names:
            return np.zeros(n_rows, dtype=np.int64)
        return _labels(name, table[name], problems)

    success = numbers("success")
    problems.rows(
        np.flatnonzero(np.isfinite(success) & (success != 0.0) & (success != 1.0)),
        "`success` is neither 0 nor 1",
        "Write 1 (true) for a trial that reached its goal and 0 (false) for one that did not.",
    )
    variant = [numbers(name) for name in variant_columns] or [np.zeros(n_rows)]
    values = np.empty((n_rows, len(features)))
    for index, name in enumerate(features):
        values[:, index] = numbers(name)
    return Table(
        parameters=tuple(name.removeprefix("variant.") for name in variant_columns),
        feature_names=tuple(features),
        variant=np.stack(variant, axis=1),
        network=labels("network"),
        trial=labels("trial"),
        success=success,
        features=values,
    )


def _check_names(
    names: Sequence[str], single: Sequence[str], several: Sequence[str], problems: Problems
) -> None:
    missing = [name for name in _KEYS if name not in names]
    if not single and not several:
        missing.insert(0, "variant")
    for name in missing:
        problems.add(f"column `{name}` is missing", _COLUMN_REMEDIES[name])
    if single and several:
        problems.add(
            f"there is both `variant` and `{several[0]}`",
            "Keep `variant` for one task parameter, or `variant.<name>` for each of several.",
        )
    if len(set(names)) < len(names):
        problems.add("two columns have the same name", "Name each column once.")
    if any(not name.strip() or name == "variant." for name in names):
        problems.add("a column has no name", "Name it, or remove it.")


_COLUMN_REMEDIES = {
    "variant": "Add the task parameter of each row as `variant`, or as `variant.<name>` for each "
    "of several parameters.",
    "network": "Add the number of the policy that acted; 0 throughout if there is one.",
    "trial": "Add the number of the repetition among those of its variant and network.",
    "success": "Add the outcome of the trial, 1 or 0, on each of its rows.",
}


def _numbers(name: str, column: Any, problems: Problems) -> FloatArray:
    array = np.asarray(column)
    if array.dtype.kind in "biuf":
        values = array.astype(np.float64)
    else:
        values = np.asarray([_number(entry) for entry in array.tolist()], dtype=np.float64)
        bad = np.asarray([_is_word(entry) for entry in array.tolist()], dtype=np.bool_)
        problems.rows(
            np.flatnonzero(bad), f"`{name}` is not a number", f"Write numbers in `{name}`."
        )
        values[bad] = 0.0
    problems.rows(
        np.flatnonzero(~(np.abs(values) <= _LARGEST_VALUE)),
        f"`{name}` is missing, NaN or infinite",
        "Drop the trial, or log a finite value.",
    )
    return values


def _number(entry: object) -> float:
    if entry is None:
        return np.nan
    text = str(entry).strip().lower()
    try:
        return _WORDS[text] if text in _WORDS else float(text or "nan")
    except ValueError:
        return np.nan


def _is_word(entry: object) -> bool:
    """Return whether an entry is text that stands for no number at all."""
    text = "" if entry is None else str(entry).strip().lower()
    if not text or text in _WORDS:
        return False
    try:
        float(text)
    except ValueError:
        return True
    return False


def _labels(name: str, column: Any, problems: Problems) -> IntArray:
    array = np.asarray(column)
    if array.dtype.kind in "biu":
        return array.astype(np.int64)
    entries = ["" if entry is None else str(entry).strip() for entry in array.tolist()]
    if array.dtype.kind != "f" and any(_is_word(entry) for entry in entries):
        empty = np.flatnonzero([not entry for entry in entries])
        problems.rows(empty, f"`{name}` is missing", f"Give each row a `{name}`.")
        return np.unique(entries, return_inverse=True)[1].astype(np.int64)
    values = _numbers(name, column, problems)
    whole = np.isfinite(values) & (np.abs(values) < 2.0**53) & (values == np.floor(values))
    problems.rows(
        np.flatnonzero(np.isfinite(values) & ~whole),
        f"`{name}` is not a whole number",
        f"Number each `{name}` from 0.",
    )
    return np.where(whole, values, 0.0).astype(np.int64)


def _empty() -> Table:
    return Table(
        parameters=("variant",),
        feature_names=(),
        variant=np.empty((0, 1)),
        network=np.empty(0, dtype=np.int64),
        trial=np.empty(0, dtype=np.int64),
        success=np.empty(0),
        features=np.empty((0, 0)),
    )
