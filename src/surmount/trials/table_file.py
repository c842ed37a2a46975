"""Columns in Parquet and CSV files, read in pieces or one by one to bound memory."""

from __future__ import annotations

import csv
import json
import os
import secrets
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from surmount.core.errors import InputError, MissingExtraError

Column = np.ndarray[Any, Any]
_CSV_PIECE_ROWS = 20_000
"""Rows parsed at once: as text they take some 60 bytes an entry."""
_WRITE_PIECE_ROWS = 100_000
BYTES_PER_ENTRY = 8
MOST_ROWS = 2**31 - 1
"""Rows are numbered in 32 bits."""
TABLE_SCHEMA = "1"
_SCHEMA_KEY = "surmount.trials"
_OTHER_SEPARATORS = ";\t|"
_WHOLE_KINDS = (np.int8, np.int16, np.int32)


_AXES_KEY = "surmount.axes"
NO_AXES: Mapping[str, Any] = MappingProxyType({})


class FileColumns(Mapping[str, Column]):
    """Columns of a file, each handed out once, so that never two copies of a table exist.

    Parameters
    ----------
    names
        Names of the columns.
    n_rows
        Length of each.
    take
        Gives a column by name and forgets it.
    axes
        What the file says of the axes of task parameters, in JSON form by parameter.
    """

    def __init__(
        self,
        names: Sequence[str],
        n_rows: int,
        take: Callable[[str], Column],
        axes: Mapping[str, Any] = NO_AXES,
    ) -> None:
        self._names = tuple(names)
        self.n_rows = n_rows
        self.axes = axes
        self._take = take

    def __getitem__(self, name: str) -> Column:
        """Return a column; it cannot be asked for again."""
        return self._take(name)

    def __iter__(self) -> Iterator[str]:
        """Go through the names."""
        return iter(self._names)

    def __len__(self) -> int:
        """Return the number of columns."""
        return len(self._names)


def read_columns(path: Path) -> FileColumns:
    """Open the columns of a Parquet or CSV file.

    A Parquet file is read column by column as they are asked for, a CSV file at once, in pieces.

    Raises
    ------
    InputError
        If the file is missing, unreadable, of another kind or version, or not a table.
    MissingExtraError
        If polars is needed and not installed.
    """
    if path.exists() and not path.is_file():  # a pipe or a device would never end
        raise InputError(f"{path} is not a file.", remedy="Give the path of a table.")
    if _kind(path) == "parquet":
        return _read_parquet(path)
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            return _read_csv(csv.reader(file, strict=True), path)
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path} is not UTF-8 text ({error.reason} at byte {error.start}).",
            remedy="Save it as CSV in UTF-8.",
        ) from error
    except (OSError, csv.Error) as error:
        raise _unreadable(path, error) from error


def write_columns(
    path: Path,
    columns: Mapping[str, np.ndarray[Any, Any]],
    axes: Mapping[str, Any] = NO_AXES,
) -> None:
    """Write columns of equal length as Parquet or CSV, whole or not at all.

    Parquet also holds what ``axes`` says of task parameters; CSV has no place for it.
    """
    kind = _kind(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        if kind == "parquet":
            polars = _polars()
            frame = polars.DataFrame(dict(columns))
            said = {_AXES_KEY: json.dumps(dict(axes))} if axes else {}
            frame.write_parquet(temporary, metadata={_SCHEMA_KEY: TABLE_SCHEMA, **said})
        else:
            _write_csv(temporary, columns)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def _kind(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix not in (".parquet", ".csv"):
        raise InputError(
            f"{path} is neither a .parquet nor a .csv file.",
            remedy="Name a table that ends in .parquet or .csv.",
        )
    return suffix.removeprefix(".")


def _polars() -> Any:
    try:
        import polars as pl  # noqa: PLC0415 - optional, only where Parquet is asked for
    except ImportError as error:
        raise MissingExtraError(
            "Parquet files need polars, which is not installed.",
            remedy='Install it with `pip install "surmount[tables]"`, or use CSV.',
        ) from error
    return pl


def _read_parquet(path: Path) -> FileColumns:
    polars = _polars()
    try:
        metadata = polars.read_parquet_metadata(path)
        version = metadata.get(_SCHEMA_KEY, TABLE_SCHEMA)
        lazy = polars.scan_parquet(path)
        types = dict(lazy.collect_schema())
        n_rows = int(lazy.select(polars.len()).collect().item())
    except (OSError, polars.exceptions.PolarsError, polars.exceptions.PanicException) as error:
        raise _unreadable(path, error) from error
    _require_memory(path, n_rows, len(types))
    if version != TABLE_SCHEMA:
        raise InputError(
            f"{path} is a table of trials of version {version}; this Surmount reads "
            f"{TABLE_SCHEMA}.",
            remedy="Read it with the version of Surmount that wrote it, and write CSV.",
        )

    def take(name: str) -> Column:
        try:
            series = lazy.select(polars.col(name)).collect().to_series()
        except (OSError, polars.exceptions.PolarsError, polars.exceptions.PanicException) as error:
            raise _unreadable(path, error) from error
        kind = types[name]
        if kind.is_numeric() or kind == polars.Boolean:
            return series.cast(polars.Float64).to_numpy()
        column = np.empty(n_rows, dtype=object)
        if kind == polars.String:
            column[:] = _shared(series, {})
        else:
            column[:] = series.to_list()
        return column

    return FileColumns(list(types), n_rows, take, _axes_said(path, metadata.get(_AXES_KEY, "{}")))


def _axes_said(path: Path, text: str) -> Mapping[str, Any]:
    try:
        axes = json.loads(text)
    except ValueError as error:
        raise _unreadable(path, error) from error
    return axes if isinstance(axes, dict) else {}


def _require_memory(path: Path, n_rows: int, n_columns: int) -> None:
    """Refuse a table that cannot fit: a few bytes of Parquet can stand for billions of rows."""
    needed = BYTES_PER_ENTRY * n_rows * n_columns
    present = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if n_rows > MOST_ROWS or needed > present:
        raise InputError(
            f"{path} holds {n_rows:,} rows of {n_columns:,} columns: {needed / 1e9:,.0f} GB, and "
            f"this machine has {present / 1e9:,.0f} GB.",
            remedy="Log fewer steps or features, or use a machine with more memory.",
        )


def _read_csv(rows: Iterator[list[str]], path: Path) -> FileColumns:
    header = [name.strip() for name in next(rows, [])]
    others = [mark for mark in _OTHER_SEPARATORS if len(header) == 1 and mark in header[0]]
    if others:
        raise InputError(
            f"{path} separates its columns by {others[0]!r}.",
            remedy="Separate them by commas, and write decimals with points.",
        )
    if len(set(header)) < len(header):
        raise InputError(
            f"{path}: two columns have the same name.", remedy="Name each column once."
        )
    parts: dict[str, list[Column]] = {name: [] for name in header}
    texts: dict[str, str] = {}
    done = 0
    while piece := list(islice(rows, _CSV_PIECE_ROWS)):
        bad = [index for index, row in enumerate(piece) if len(row) != len(header)]
        if bad:
            raise InputError(
                f"{path}: row {done + bad[0] + 1} has {len(piece[bad[0]])} entries under "
                f"{len(header)} column names.",
                remedy="Give each row one entry per column, separated by commas.",
            )
        done += len(piece)
        for name, entries in zip(header, zip(*piece, strict=True), strict=True):
            parts[name].append(_typed(entries, texts))

    def take(name: str) -> Column:
        return np.concatenate(parts.pop(name) or [np.empty(0)])

    return FileColumns(header, done, take)


def _typed(entries: tuple[str, ...], texts: dict[str, str]) -> Column:
    """Return entries as numbers where all are, in the smallest type that holds them exactly."""
    try:
        values = np.asarray(entries, dtype=np.float64)
    except ValueError:
        column = np.empty(len(entries), dtype=object)
        column[:] = _shared(entries, texts)
        return column
    largest = float(np.abs(values).max())  # NaN compares as false below
    whole = largest < 2.0**31 and bool((values == np.floor(values)).all())
    if whole and not bool(np.signbit(values[values == 0.0]).any()):
        kind = next(kind for kind in _WHOLE_KINDS if largest <= np.iinfo(kind).max)
        return values.astype(kind)
    return values


def _shared(entries: Iterable[Any], texts: dict[Any, Any]) -> list[Any]:
    """Return the entries with equal texts as one object, which takes 8 bytes each."""
    return [texts.setdefault(entry, entry) for entry in entries]


def _write_csv(path: Path, columns: Mapping[str, np.ndarray[Any, Any]]) -> None:
    n_rows = next(iter(columns.values())).shape[0]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        for start in range(0, n_rows, _WRITE_PIECE_ROWS):
            piece = [
                column[start : start + _WRITE_PIECE_ROWS].astype(np.int64).tolist()
                if column.dtype.kind == "b"
                else column[start : start + _WRITE_PIECE_ROWS].tolist()
                for column in columns.values()
            ]
            writer.writerows(zip(*piece, strict=True))


def _unreadable(path: Path, error: Exception) -> InputError:
    text = str(error).splitlines()[0] if str(error) else type(error).__name__
    return InputError(
        f"{path} cannot be read as a table ({text}).",
        remedy="Give the path of a readable Parquet or CSV file.",
    )
