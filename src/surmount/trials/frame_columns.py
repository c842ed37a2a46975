"""Columns in memory: dictionaries of arrays, and data frames of pandas, Polars or Arrow."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from datetime import date, datetime, time, timedelta
from typing import Any

import numpy as np
import polars as pl

from surmount.core.errors import InputError
from surmount.trials.source import POLARS_ERRORS, Source
from surmount.trials.table_problems import Problems

_MISSING = {"nan", "NaN", "NaT", "<NA>"}
"""How NumPy, pandas and Polars print an entry that is missing."""
_RESOLUTIONS = ("ns", "us", "ms")
"""Resolutions of NumPy's times that Polars has as well."""


def open_frame(table: Any, name: str) -> Source:
    """Open columns of equal length: a dictionary of arrays, or any data frame.

    Raises
    ------
    InputError
        If this is no table of columns at all, its columns differ in length, or two have one name.
    """
    if isinstance(table, pl.LazyFrame):
        return Source(name=name, frame=table)
    if isinstance(table, pl.DataFrame):
        return Source(name=name, frame=table.lazy())
    if not isinstance(table, Mapping) and not hasattr(table, "columns"):
        if hasattr(table, "__arrow_c_stream__"):
            return Source(name=name, frame=pl.DataFrame(table).lazy())
        raise InputError(
            f"{name} is a {type(table).__name__}, not a table of columns.",
            remedy="Give a dictionary of arrays, or a data frame of pandas, Polars or Arrow.",
        )
    if hasattr(table, "column_names"):  # Arrow's own tables, whose `columns` are not names
        return Source(name=name, frame=pl.DataFrame(table).lazy())
    problems = Problems()
    keys: list[Any] = list(getattr(table, "columns", table))
    names = [str(key) for key in keys]
    levels = _index_levels(table, names)
    again = sorted(one for one, times in Counter(names).items() if times > 1)
    for one in again:
        problems.add(f"several columns have the name `{one}`", "Name each column once.")
    found = {
        column: _series(column, table[key])
        for column, key in zip(names, keys, strict=True)
        if column not in again
    } | {column: _series(column, values) for column, values in levels.items()}
    odd = [column for column, series in found.items() if series is None]
    for column in odd:
        problems.add(f"`{column}` has not one value per row", "Give one number per row.")
    columns = {column: series for column, series in found.items() if series is not None}
    if len({series.len() for series in columns.values()}) > 1:
        listed = ", ".join(f"{column} {series.len()}" for column, series in columns.items())
        problems.add(f"columns differ in length ({listed})", "Give each column one entry per row.")
    problems.raise_if_any(name)
    notes = (f"The index `{level}` was read as a column." for level in levels)
    return Source(name=name, frame=pl.DataFrame(columns).lazy(), notes=tuple(notes))


def _index_levels(table: Any, names: list[str]) -> dict[str, Any]:
    """Return what the index of a frame of pandas says besides the numbers of its rows.

    Levels without a name get the one that pandas writes for them. Whole numbers without a name are
    those of rows, and a level of a column's name is that column.
    """
    index = getattr(table, "index", None)
    levels: dict[str, Any] = {}
    for place, level in enumerate(getattr(index, "names", ())):
        values = index.get_level_values(place)  # type: ignore[union-attr]
        if level is None and values.dtype.kind in "iu" and len(index.names) == 1:  # type: ignore[union-attr]
            continue
        name = f"__index_level_{place}__" if level is None else str(level)
        if name not in names:
            levels[name] = values
    return levels


def _series(name: str, values: Any) -> pl.Series | None:
    """Return a column with one type for all of its entries; ``None`` where it is no column."""
    if isinstance(values, pl.Series):
        return values.alias(name)
    if isinstance(values, np.ma.MaskedArray):
        entries = np.asarray(values.data, dtype=object)
        entries[np.ma.getmaskarray(values)] = None
        return _of_objects(name, entries.tolist())
    try:
        array = np.asarray(values)
    except ValueError:  # lists of unequal length
        return _of_objects(name, list(values))
    if array.ndim == 0 or array.ndim > 2:
        return None
    kind = array.dtype.kind
    if array.ndim == 2:
        return pl.Series(name, array) if kind in "biuf" else None
    if kind in "biuf":
        wide = array.astype(np.float64) if array.dtype.itemsize > 8 else array
        return pl.Series(name, np.ascontiguousarray(wide.astype(wide.dtype.newbyteorder("="))))
    if kind in "mM":
        unit = np.datetime_data(array.dtype)[0]
        if unit not in _RESOLUTIONS:
            exact = "ms" if unit in ("s", "m", "h", "D") else "ns"
            array = array.astype(f"{kind}8[{exact}]")
        return pl.Series(name, array)
    return _of_objects(name, array.tolist())


def _of_objects(name: str, entries: list[Any]) -> pl.Series:
    """Return entries of any kinds as numbers, times or lists where all are, else as text."""
    kept = [None if _missing(entry) else entry for entry in entries]
    kinds = {type(entry) for entry in kept if entry is not None}
    whole = all(issubclass(kind, int | np.integer) and kind is not bool for kind in kinds)
    real = all(issubclass(kind, int | float | np.number) and kind is not bool for kind in kinds)
    try:
        if kinds <= {bool, np.bool_}:
            return pl.Series(name, kept, dtype=pl.Boolean)
        if whole and all(entry is None or -(2**63) <= entry < 2**63 for entry in kept):
            return pl.Series(name, [None if e is None else int(e) for e in kept], dtype=pl.Int64)
        if real and not whole and not any(issubclass(kind, np.complexfloating) for kind in kinds):
            return pl.Series(name, [None if e is None else float(e) for e in kept])
        if kinds <= {list, tuple, np.ndarray} or all(
            issubclass(kind, datetime | date | time | timedelta) for kind in kinds
        ):
            return pl.Series(name, kept)
    except (TypeError, ValueError, OverflowError, *POLARS_ERRORS):
        pass  # as text, and then told as what it is
    return pl.Series(name, [None if e is None else as_text(e) for e in kept], dtype=pl.String)


def as_text(entry: object) -> str:
    """Return an entry as text; bytes, as HDF5 and NumPy keep text, are UTF-8."""
    text = entry.decode("utf-8", "replace") if isinstance(entry, bytes) else str(entry)
    return text.encode("utf-8", "replace").decode() if not text.isascii() else text


def _missing(entry: object) -> bool:
    return entry is None or (not isinstance(entry, str) and str(entry) in _MISSING)
