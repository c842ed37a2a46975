"""A folder with one file per trial, or per session: what its name or a table beside it says.

A trial never spans two files, so numbers of trials may begin anew in each.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from surmount.core.axis import axes_from_record, axes_to_record, common_axes
from surmount.core.errors import ConfigError, InputError, SurmountError
from surmount.trials.column_types import DECIMAL_COMMA
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
        return open_minari(path, columns)
    beside = Path(columns.beside) if columns.beside else path / _BESIDE
    known = _table_beside(beside) if columns.beside or _has_files(beside) else {}
    files = [
        file
        for file in sorted(path.rglob("*"))
        if (ending(file) and not _is_hidden(file, path) and file.resolve() != beside.resolve())
        or (file == beside and not known)
    ]
    if not files:
        raise InputError(
            f"{path} holds no tables.", remedy="Give a folder with one table per trial."
        )
    names = [_bare_name(file.relative_to(path)) for file in files]
    _check_names(names, files, path)
    told = _told_by_names(names, columns.names, path)
    notes: list[str] = []
    if known:
        told = _told_by_table(names, told, known, beside)
        absent = [f"`{name}`" for name in known if name not in names]
        if absent:
            notes.append(
                f"{beside} names {_shortened(absent)}, which {path} does not hold: nothing was "
                "read of that."
            )
    return _joined(path, names, [open_file(file) for file in files], told, notes)


def _is_hidden(file: Path, path: Path) -> bool:
    """Whether a file or a folder above it, within the folder, is not meant to be seen."""
    return any(part.startswith(".") for part in file.relative_to(path).parts)


def _check_names(names: Sequence[str], files: Sequence[Path], path: Path) -> None:
    """Refuse two files of one name: nobody knows whether they are two trials, or one twice."""
    for name, times in Counter(names).items():
        if times > 1:
            alike = [file.name for file, one in zip(files, names, strict=True) if one == name]
            raise InputError(
                f"{path}: {' and '.join(alike)} have the same name `{name}`.",
                remedy="Keep one of them, or give each trial a name of its own.",
            )


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
    if source.decimal_commas:
        table = table.with_columns(_with_points(pl.exclude(_FILE)))
    if _FILE not in table.columns:
        raise InputError(
            f"{beside} has no column `{_FILE}`.",
            remedy="Name in it the file that the other columns speak of.",
        )
    found: dict[str, dict[str, str]] = {}
    for row in table.iter_rows(named=True):
        file = _bare_name(Path(row.pop(_FILE) or "?"))
        if file in found:
            raise InputError(
                f"{beside} has two rows for `{file}`.", remedy="Write one row for each file."
            )
        found[file] = {name: value for name, value in row.items() if value is not None}
    return found


def _with_points(text: pl.Expr) -> pl.Expr:
    """Return decimals with points, where a column has no points but commas."""
    commas = text.str.contains(DECIMAL_COMMA) & ~text.str.contains(".", literal=True).any()
    return pl.when(commas).then(text.str.replace(",", ".", literal=True)).otherwise(text)


def _told_by_table(
    names: Sequence[str],
    told: Sequence[dict[str, str]],
    known: Mapping[str, dict[str, str]],
    beside: Path,
) -> list[dict[str, str]]:
    """Add what the table says of each file."""
    without = [f"`{name}`" for name in names if name not in known]
    if without:
        raise InputError(
            f"{beside} says nothing of {_shortened(without)}.",
            remedy="Write one row for each file, with its name under `file`.",
        )
    return [own | known[name] for name, own in zip(names, told, strict=True)]


def _shortened(names: Sequence[str]) -> str:
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f"{', '.join(names[:3])}{more}"


def _joined(
    path: Path,
    names: Sequence[str],
    sources: Sequence[Source],
    told: Sequence[dict[str, str]],
    notes: Sequence[str],
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
        told=frozenset(added),
        notes=(*notes, *dict.fromkeys(note for source in sources for note in source.notes)),
        axes=_axes_of_all(path, sources),
        explain=explain,
    )


def _axes_of_all(path: Path, sources: Sequence[Source]) -> dict[str, Any]:
    """Return what files say of the axes of task parameters, if all say the same.

    Categories are those of all files. Where a file does not tell its own, they are found anew.
    """
    said: dict[str, list[Any]] = {}
    for source in sources:
        for name, record in source.axes.items():
            said.setdefault(name, []).append(record)
    try:
        names = [
            name
            for name, records in said.items()
            if len(records) == len(sources) or {one["kind"] for one in records} != {"categorical"}
        ]
        every = [axes_from_record(source.axes, names) for source in sources]
        return axes_to_record(common_axes(every, names), names)
    except (SurmountError, KeyError, TypeError, AttributeError) as error:
        why = error.message if isinstance(error, SurmountError) else "damaged"
        raise InputError(
            f"{path}: files do not say the same of the axes of variants ({why.rstrip('.')}).",
            remedy="Write all of them by `write_trials`, with the same axes.",
        ) from error


def _place(names: Sequence[str], sources: Sequence[Source], row: int) -> str:
    """Return a row of all files together as a row of one."""
    lengths = [source.collect(source.frame.select(pl.len())).item() for source in sources]
    ends = np.cumsum(lengths)
    file = int(np.searchsorted(ends, row, side="right"))
    own = row - int(ends[file] - lengths[file])
    return f"{sources[file].place(own)} of {names[file]}"
