"""Files that hold tables: found by their ending, opened without being read, and written."""

from __future__ import annotations

import glob
import json
import secrets
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import polars as pl

from surmount.core.errors import InputError
from surmount.trials.checksum import PLACE, check, stamp
from surmount.trials.csv_file import CSV_ENDINGS, open_csv
from surmount.trials.source import POLARS_ERRORS, Source

TABLE_SCHEMA = "1"
_SCHEMA_KEY = "surmount.trials"
_AXES_KEY = "surmount.axes"
_ARROW_ENDINGS = (".arrow", ".feather", ".ipc")
_COMPRESSED = (".gz", ".zst", ".zstd")
ENDINGS = (".parquet", *_ARROW_ENDINGS, *CSV_ENDINGS)
"""Endings of tables; those of CSV may be followed by one of a compression."""


def ending(path: Path) -> str:
    """Return what kind of table a file is by its name, ``""`` if it is none: ``".csv"``."""
    suffixes = [suffix.lower() for suffix in path.suffixes[-2:]]
    if len(suffixes) == 2 and suffixes[1] in _COMPRESSED and suffixes[0] in CSV_ENDINGS:
        return suffixes[0]
    return suffixes[-1] if suffixes and suffixes[-1] in ENDINGS else ""


def open_file(path: Path) -> Source:
    """Open a table: CSV (``.csv``, ``.tsv``, ``.txt``; gzip, zstd), Parquet or Arrow.

    Raises
    ------
    InputError
        If the file is missing, unreadable, of another kind or version.
    """
    if path.exists() and not path.is_file():  # a pipe or a device would never end
        raise InputError(f"{path} is not a file.", remedy="Give the path of a table.")
    kind = ending(path)
    if not kind:
        raise InputError(
            f"{path} does not end in a way that tells what table it is.",
            remedy=f"Name a table that ends in {', '.join(ENDINGS)}; CSV also in .csv.gz or "
            ".csv.zst.",
        )
    if not path.exists():
        raise InputError(f"{path} does not exist.", remedy="Give the path of a table.")
    if kind in CSV_ENDINGS:
        return open_csv(path)
    if kind == ".parquet":
        axes = _axes_said(path)
        return Source(name=str(path), frame=pl.scan_parquet(path, glob=False), axes=axes)
    exact = glob.escape(str(path))  # Polars before 1.36 has no `glob=False` here
    return Source(name=str(path), frame=pl.scan_ipc(exact))


def _axes_said(path: Path) -> Mapping[str, Any]:
    """Return what a Parquet file says of axes, if its version is one that is read here."""
    check(path)
    try:
        metadata = pl.read_parquet_metadata(path)
        version = metadata.get(_SCHEMA_KEY, TABLE_SCHEMA)
        axes = json.loads(metadata.get(_AXES_KEY, "{}"))
    except (OSError, ValueError, *POLARS_ERRORS) as error:
        raise InputError(
            f"{path} cannot be read as a table: it is damaged, or no Parquet.",
            remedy="Give the path of a readable table.",
        ) from error
    if version != TABLE_SCHEMA:
        raise InputError(
            f"{path} is a table of trials of version {version}; this Surmount reads "
            f"{TABLE_SCHEMA}.",
            remedy="Read it with the version of Surmount that wrote it, and write CSV.",
        )
    return axes if isinstance(axes, dict) else {}


def require_writable_kind(path: Path) -> None:
    """Refuse a table to write that ends neither in ``.parquet`` nor in ``.csv``.

    Raises
    ------
    InputError
        If it does not.
    """
    if path.suffix.lower() not in (".parquet", ".csv"):
        raise InputError(
            f"{path} is neither a .parquet nor a .csv file.",
            remedy="Name a table that ends in .parquet or .csv.",
        )
    if path.is_dir():
        raise InputError(f"{path} is a folder.", remedy="Give the name of a file.")


def write_columns(
    path: Path,
    columns: Mapping[str, np.ndarray[Any, Any]],
    axes: Mapping[str, Any] = MappingProxyType({}),
) -> None:
    """Write columns of equal length as Parquet or CSV, whole or not at all.

    Parquet also holds what ``axes`` says of task parameters; CSV has no place for it.
    """
    require_writable_kind(path)
    kind = path.suffix.lower()
    path.parent.mkdir(parents=True, exist_ok=True)
    frame = pl.DataFrame(dict(columns))
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        if kind == ".parquet":
            said = {_AXES_KEY: json.dumps(dict(axes))} if axes else {}
            said |= {_SCHEMA_KEY: TABLE_SCHEMA, **PLACE}
            frame.write_parquet(temporary, metadata=said)
            stamp(temporary)
        else:
            flags = pl.selectors.boolean().cast(pl.Int8)
            frame.with_columns(flags).write_csv(temporary)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
