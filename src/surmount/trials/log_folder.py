"""A folder with one file per trial, or per session: what its name or a table beside it says.

A trial never spans two files, so numbers of trials may begin anew in each.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import polars as pl

from surmount.core.errors import ConfigError, InputError
from surmount.trials.columns import FILE_COLUMN, Columns
from surmount.trials.minari import is_minari, open_minari
from surmount.trials.source import POLARS_ERRORS, Source
from surmount.trials.table_file import ending, open_file

_BESIDE = "trials.csv"
_FILE = "file"
_FIELD = re.compile(r"\{([^{}]+)\}")


def open_path(path: Path, columns: Columns) -> Source:
    """Open a table, a folder of tables, or a Minari data set.

    Raises
    ------
    ConfigError
        If names of files are described, and this is no folder.
    InputError
        If there is nothing to be read, or files do not fit each other.
    """
    if not path.is_dir():
        if columns.names or columns.beside:
            raise ConfigError(
                f"Names of files or a table beside are given, but {path} is not a folder.",
                remedy="Give the folder that holds one file per trial.",
            )
        return open_file(path)
    if is_minari(path):
        return open_minari(path)
    beside = Path(columns.beside) if columns.beside else path / _BESIDE
    known = _table_beside(beside) if columns.beside or _has_files(beside) else {}
    files = [
        file
        for file in sorted(path.rglob("*"))
        if (ending(file) and not file.name.startswith(".") and file.resolve() != beside.resolve())
        or (file == beside and not known)
    ]
    if not files:
        raise InputError(
            f"{path} holds no tables.", remedy="Give a folder with one table per trial."
        )
    names = [_bare_name(file.relative_to(path)) for file in files]
    told = _told_by_names(names, columns.names, path)
    if known:
        told = _told_by_table(files, path, told, known, beside)
    return _joined(path, names, [open_file(file) for file in files], told)


def _bare_name(file: Path) -> str:
    """Return a file's path within its folder, without the ending."""
    name = file.as_posix()
    for suffix in reversed(file.suffixes[-2:]):
        if ending(Path(f"x{suffix}")) or suffix.lower() in (".gz", ".zst", ".zstd"):
            name = name.removesuffix(suffix)
    return name


def _told_by_names(names: Sequence[str], pattern: str, path: Path) -> list[dict[str, str]]:
    if not pattern:
        return [{} for _ in names]
    fields = [field.strip() for field in _FIELD.findall(pattern)]
    if not fields or len(set(fields)) < len(fields):
        raise ConfigError(
            f"`{pattern}` does not name the parts of a file's name.",
            remedy='Write it as "width{variant.width_m}_net{network}", each part once.',
        )
    parts = [re.escape(part) for part in _FIELD.split(pattern)[::2]]
    expression = re.compile("(.+?)".join(parts))
    found: list[dict[str, str]] = []
    for name in names:
        match = expression.fullmatch(name)
        if not match:
            raise InputError(
                f"{path}: the name of the file `{name}` is not as `{pattern}`.",
                remedy="Describe the names of all files, without their endings, or move others "
                "away.",
            )
        found.append(dict(zip(fields, match.groups(), strict=True)))
    return found


def _has_files(beside: Path) -> bool:
    return beside.is_file() and _FILE in open_file(beside).schema()


def _table_beside(beside: Path) -> dict[str, dict[str, str]]:
    source = open_file(beside)
    table = source.collect(source.frame.select(pl.all().cast(pl.String).str.strip_chars()))
    if _FILE not in table.columns:
        raise InputError(
            f"{beside} has no column `{_FILE}`.",
            remedy="Name in it the file that the other columns speak of.",
        )
    found: dict[str, dict[str, str]] = {}
    for row in table.iter_rows(named=True):
        file = str(row.pop(_FILE) or "")
        if file in found:
            raise InputError(
                f"{beside} has two rows for `{file}`.", remedy="Write one row for each file."
            )
        found[file] = {name: value for name, value in row.items() if value is not None}
    return found


def _told_by_table(
    files: Sequence[Path],
    path: Path,
    told: list[dict[str, str]],
    known: Mapping[str, dict[str, str]],
    beside: Path,
) -> list[dict[str, str]]:
    """Add what the table says of each file, by its path with or without its ending."""
    found: list[dict[str, str]] = []
    without: list[str] = []
    for file, own in zip(files, told, strict=True):
        inside = file.relative_to(path)
        row = known.get(inside.as_posix(), known.get(_bare_name(inside)))
        if row is None:
            without.append(inside.as_posix())
        found.append(own | (row or {}))
    if without:
        more = f" and {len(without) - 3} more" if len(without) > 3 else ""
        raise InputError(
            f"{beside} says nothing of {', '.join(without[:3])}{more}.",
            remedy="Write one row for each file, with its name under `file`.",
        )
    return found


def _joined(
    path: Path, names: Sequence[str], sources: Sequence[Source], told: list[dict[str, str]]
) -> Source:
    added = list(dict.fromkeys(name for one in told for name in one))
    wanted = list(sources[0].schema())
    for name, source in zip(names, sources, strict=True):
        if sorted(source.schema()) != sorted(wanted):
            odd = sorted(set(source.schema()) ^ set(wanted))
            raise InputError(
                f"{path}: `{name}` and `{names[0]}` do not have the same columns "
                f"({', '.join(odd[:5])}).",
                remedy="Log the same columns in every file.",
            )
    frames = [
        source.frame.select(
            *(name for name in wanted if name not in added),
            *(pl.lit(own.get(column), dtype=pl.String).alias(column) for column in added),
            pl.lit(name).alias(FILE_COLUMN),
        )
        for name, source, own in zip(names, sources, told, strict=True)
    ]
    try:
        frame = pl.concat(frames, how="vertical_relaxed")
    except POLARS_ERRORS as error:
        raise InputError(
            f"{path}: a column is text in one file and numbers in another.",
            remedy="Log each column alike in every file.",
        ) from error

    def explain() -> None:
        for source in sources:
            source.collect(source.frame.select(pl.all().is_null().sum()))

    return Source(
        name=str(path),
        frame=frame,
        place=partial(_place, names, sources),
        decimal_commas=all(source.decimal_commas for source in sources),
        notes=tuple(dict.fromkeys(note for source in sources for note in source.notes)),
        explain=explain,
    )


def _place(names: Sequence[str], sources: Sequence[Source], row: int) -> str:
    """Return a row of all files together as a row of one."""
    lengths = [source.collect(source.frame.select(pl.len())).item() for source in sources]
    ends = np.cumsum(lengths)
    file = int(np.searchsorted(ends, row, side="right"))
    own = row - int(ends[file] - lengths[file])
    return f"{sources[file].place(own)} of {names[file]}"
