"""Columns in Parquet and CSV files, read in pieces to bound memory."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.errors import InputError, MissingExtraError

Columns = dict[str, np.ndarray[Any, Any]]
_PIECE_ROWS = 100_000
TABLE_SCHEMA = "1"
_SCHEMA_KEY = "surmount.trials"


def read_columns(path: Path) -> Columns:
    """Read all columns of a Parquet or CSV file.

    Raises
    ------
    InputError
        If the file is missing, unreadable, of another kind or version, or not a table.
    MissingExtraError
        If polars is needed and not installed.
    """
    if _kind(path) == "parquet":
        return _read_parquet(path)
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            return _join(_csv_pieces(csv.reader(file, strict=True), path))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise _unreadable(path, error) from error


def write_columns(path: Path, columns: Mapping[str, np.ndarray[Any, Any]]) -> None:
    """Write columns of equal length as Parquet or CSV, whole or not at all."""
    kind = _kind(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        if kind == "parquet":
            polars = _polars()
            frame = polars.DataFrame(dict(columns))
            frame.write_parquet(temporary, metadata={_SCHEMA_KEY: TABLE_SCHEMA})
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


def _read_parquet(path: Path) -> Columns:
    polars = _polars()
    try:
        version = polars.read_parquet_metadata(path).get(_SCHEMA_KEY, TABLE_SCHEMA)
        lazy = polars.scan_parquet(path)
        types = dict(lazy.collect_schema())
        n_rows = int(lazy.select(polars.len()).collect().item())
    except (OSError, polars.exceptions.PolarsError) as error:
        raise _unreadable(path, error) from error
    if version != TABLE_SCHEMA:
        raise InputError(
            f"{path} is a table of trials of version {version}; this Surmount reads "
            f"{TABLE_SCHEMA}.",
            remedy="Read it with the version of Surmount that wrote it, and write CSV.",
        )
    numeric = {name: kind.is_numeric() or kind == polars.Boolean for name, kind in types.items()}
    columns: Columns = {
        name: np.empty(n_rows, dtype=np.float64 if plain else object)
        for name, plain in numeric.items()
    }
    for start in range(0, n_rows, _PIECE_ROWS):
        piece = lazy.slice(start, _PIECE_ROWS).collect()
        for name, column in columns.items():
            values = piece[name].cast(polars.Float64) if numeric[name] else piece[name]
            column[start : start + piece.height] = values.to_numpy()
    return columns


def _csv_pieces(rows: Iterator[list[str]], path: Path) -> Iterator[Columns]:
    header = [name.strip() for name in next(rows, [])]
    if len(set(header)) < len(header):
        raise InputError(
            f"{path}: two columns have the same name.", remedy="Name each column once."
        )
    done = 0
    while piece := list(islice(rows, _PIECE_ROWS)):
        bad = [index for index, row in enumerate(piece) if len(row) != len(header)]
        if bad:
            raise InputError(
                f"{path}: row {done + bad[0] + 1} has {len(piece[bad[0]])} entries under "
                f"{len(header)} column names.",
                remedy="Give each row one entry per column, separated by commas.",
            )
        done += len(piece)
        yield {
            name: _typed(column)
            for name, column in zip(header, zip(*piece, strict=True), strict=True)
        }
    if not done:
        yield {name: np.empty(0) for name in header}


def _typed(entries: tuple[str, ...]) -> np.ndarray[Any, Any]:
    try:
        return np.asarray(entries, dtype=np.float64)
    except ValueError:
        return np.asarray(entries, dtype=object)


def _join(pieces: Iterator[Columns]) -> Columns:
    parts: dict[str, list[np.ndarray[Any, Any]]] = {}
    for piece in pieces:
        for name, column in piece.items():
            parts.setdefault(name, []).append(column)
    return {name: np.concatenate(parts.pop(name)) for name in list(parts)}


def _write_csv(path: Path, columns: Mapping[str, np.ndarray[Any, Any]]) -> None:
    n_rows = next(iter(columns.values())).shape[0]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        for start in range(0, n_rows, _PIECE_ROWS):
            piece = [
                column[start : start + _PIECE_ROWS].astype(np.int64).tolist()
                if column.dtype.kind == "b"
                else column[start : start + _PIECE_ROWS].tolist()
                for column in columns.values()
            ]
            writer.writerows(zip(*piece, strict=True))


def _unreadable(path: Path, error: Exception) -> InputError:
    text = str(error).splitlines()[0] if str(error) else type(error).__name__
    return InputError(
        f"{path} cannot be read as a table ({text}).",
        remedy="Give the path of a readable Parquet or CSV file.",
    )
