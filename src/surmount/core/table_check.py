"""Checks on the columns of a table of trials, all problems gathered before anything is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.core.table_file import FileColumns

CodeArray = NDArray[np.int32]

_KEYS = ("network", "trial", "success")
_LARGEST_VALUE = 1e100
"""Larger values count as infinite: their squares overflow."""
_PIECE_ROWS = 100_000
_SHOWN_ROWS = 5
_SHOWN_PROBLEMS = 20
_WORDS = {"true": 1.0, "false": 0.0, "yes": 1.0, "no": 0.0}


@dataclass(frozen=True, kw_only=True, eq=False)
class Coded:
    """A column with few distinct entries, 4 bytes a row.

    Attributes
    ----------
    distinct
        Distinct entries, ascending; shape ``(entry,)``, or ``(entry, parameter)``.
    code
        Index into them of each row, shape ``(row,)``.
    """

    distinct: np.ndarray[Any, Any]
    code: CodeArray

    def paired(self, other: Coded) -> Coded:
        """Return the distinct pairs of entries, in ascending order, as pairs of codes."""
        factor = other.distinct.shape[0]
        pairs = coded(
            lambda rows: self.code[rows].astype(np.int64) * factor + other.code[rows],
            self.code.size,
        )
        first, second = np.divmod(pairs.distinct, factor)
        return Coded(distinct=np.stack([first, second], axis=1), code=pairs.code)


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """Columns of a table of trials, one entry per row.

    Attributes
    ----------
    parameters, feature_names
        Names of the task parameters and of the features.
    variant
        Distinct variants, shape ``(variant, parameter)``.
    network, trial
        Distinct integers; names are numbered in alphabetical order.
    success
        Shape ``(row,)``.
    features
        Shape ``(row, feature)``, each feature contiguous.
    """

    parameters: tuple[str, ...]
    feature_names: tuple[str, ...]
    variant: Coded
    network: Coded
    trial: Coded
    success: BoolArray
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
    keys = {str(key): key for key in getattr(table, "columns", table)}
    names = [str(key) for key in getattr(table, "columns", table)]
    single = ["variant"] if "variant" in names else []
    several = [name for name in names if name.startswith("variant.")]
    _check_names(names, single, several, problems)
    variant_columns = single or several
    features = [name for name in names if name not in {*variant_columns, *several, *_KEYS}]
    if not features:
        problems.add("there is no feature column", "Log at least one feature per control step.")
    if isinstance(table, FileColumns):
        shapes = {(table.n_rows,)} if names else set[tuple[int, ...]]()
    else:
        shapes = {np.asarray(table[key]).shape for key in keys.values()}
    if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
        problems.add("columns differ in length", "Give each column one entry per row.")
        return _empty()
    n_rows = next(iter(shapes))[0] if shapes else 0
    if n_rows == 0:
        problems.add("the table has no rows", "Log at least one trial.")
        return _empty()

    def numbers(name: str, found: Problems = problems) -> FloatArray:
        if name not in keys:
            return np.zeros(n_rows)
        return _numbers(name, np.asarray(table[keys[name]]), found)

    def labels(name: str, found: Problems) -> Coded:
        if name not in keys:
            return Coded(distinct=np.zeros(1, np.int64), code=np.zeros(n_rows, np.int32))
        return _labels(name, np.asarray(table[keys[name]]), found)

    success = numbers("success")
    problems.rows(
        _rows_where(lambda x: np.isfinite(x) & (x != 0.0) & (x != 1.0), success),
        "`success` is neither 0 nor 1",
        "Write 1 (true) for a trial that reached its goal and 0 (false) for one that did not.",
    )
    reached = success > 0.5
    del success
    variant = _variants([numbers(name) for name in variant_columns] or [np.zeros(n_rows)])
    # Identities before features, so that the space they need while being coded is free again.
    about_labels = Problems()
    network, trial = labels("network", about_labels), labels("trial", about_labels)
    values = np.empty((len(features), n_rows)).T
    for index, name in enumerate(features):
        values[:, index] = numbers(name)
    problems.found.extend(about_labels.found)
    return Table(
        parameters=tuple(name.removeprefix("variant.") for name in variant_columns),
        feature_names=tuple(features),
        variant=variant,
        network=network,
        trial=trial,
        success=reached,
        features=values,
    )


def coded(entries: Callable[[slice], np.ndarray[Any, Any]], n_rows: int) -> Coded:
    """Return a column in coded form, built from pieces of its rows."""
    pieces = list(row_pieces(n_rows))
    distinct = np.unique(np.concatenate([np.unique(entries(rows)) for rows in pieces]))
    code = np.empty(n_rows, dtype=np.int32)
    for rows in pieces:
        code[rows] = np.searchsorted(distinct, entries(rows))
    return Coded(distinct=distinct, code=code)


def row_pieces(n_rows: int) -> Iterator[slice]:
    """Divide rows into slices, so that intermediate results stay small."""
    for start in range(0, n_rows, _PIECE_ROWS):
        yield slice(start, min(start + _PIECE_ROWS, n_rows))


def _variants(columns: Sequence[FloatArray]) -> Coded:
    """Return the distinct combinations of task parameters in ascending order."""
    first, *others = (coded(column.__getitem__, column.size) for column in columns)
    variants = Coded(distinct=first.distinct[:, None], code=first.code)
    for other in others:
        pairs = variants.paired(other)
        known, added = pairs.distinct.T
        distinct = np.column_stack([variants.distinct[known], other.distinct[added]])
        variants = Coded(distinct=distinct, code=pairs.code)
    return variants


def _rows_where(condition: Callable[[FloatArray], BoolArray], values: FloatArray) -> IntArray:
    """Return the rows, ascending, whose values fulfil a condition."""
    found = [
        np.flatnonzero(condition(values[rows])) + rows.start for rows in row_pieces(values.size)
    ]
    return np.concatenate(found).astype(np.int64)


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


def _numbers(name: str, array: np.ndarray[Any, Any], problems: Problems) -> FloatArray:
    if array.dtype.kind in "biuf":
        values = array.astype(np.float64, copy=False)
    else:
        values = np.empty(array.size)
        bad = np.zeros(array.size, dtype=np.bool_)
        for rows in row_pieces(array.size):
            entries = array[rows].tolist()
            values[rows] = [_number(entry) for entry in entries]
            bad[rows] = [_is_word(entry) for entry in entries]
        problems.rows(
            np.flatnonzero(bad), f"`{name}` is not a number", f"Write numbers in `{name}`."
        )
        values[bad] = 0.0
    problems.rows(
        _rows_where(lambda x: ~(np.abs(x) <= _LARGEST_VALUE), values),
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


def _labels(name: str, array: np.ndarray[Any, Any], problems: Problems) -> Coded:
    n_rows = array.size
    if array.dtype.kind in "biu":
        return coded(lambda rows: array[rows].astype(np.int64), n_rows)
    if array.dtype.kind != "f":
        texts: dict[str, int] = {}
        code = np.empty(n_rows, dtype=np.int32)
        for rows in row_pieces(n_rows):
            entries = ("" if entry is None else str(entry).strip() for entry in array[rows])
            code[rows] = [texts.setdefault(entry, len(texts)) for entry in entries]
        if any(_is_word(text) for text in texts):
            if "" in texts:
                empty = np.flatnonzero(code == texts[""])
                problems.rows(empty, f"`{name}` is missing", f"Give each row a `{name}`.")
            rank = np.unique(list(texts), return_inverse=True)[1].astype(np.int32)
            return Coded(distinct=np.arange(rank.size), code=rank[code])
    values = _numbers(name, array, problems)
    broken = _rows_where(lambda x: np.isfinite(x) & ~_whole(x), values)
    problems.rows(broken, f"`{name}` is not a whole number", f"Number each `{name}` from 0.")
    return coded(
        lambda rows: np.where(_whole(values[rows]), values[rows], 0.0).astype(np.int64), n_rows
    )


def _whole(values: FloatArray) -> BoolArray:
    finite = np.isfinite(values) & (np.abs(values) < 2.0**53)
    return finite & (values == np.floor(np.where(finite, values, 0.0)))


def _empty() -> Table:
    nothing = Coded(distinct=np.empty(0, np.int64), code=np.empty(0, np.int32))
    return Table(
        parameters=("variant",),
        feature_names=(),
        variant=Coded(distinct=np.empty((0, 1)), code=nothing.code),
        network=nothing,
        trial=nothing,
        success=np.empty(0, np.bool_),
        features=np.empty((0, 0)),
    )
