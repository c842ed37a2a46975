"""Columns that hold the numbers of rows, as pandas writes them, and no behaviour."""

from __future__ import annotations

import re
from dataclasses import replace

import polars as pl

from surmount.trials.columns import Columns
from surmount.trials.source import Source
from surmount.trials.table_problems import Problems

_NAMES = re.compile(r"\s*|__index_level_\d+__|Unnamed: \d+(\.\d+)*")
"""Names of an index that has none: in CSV, in Parquet, and in CSV that was read and written."""


def without_row_numbers(source: Source, columns: Columns, problems: Problems) -> Source:
    """Leave out an index of rows, with a note; note a problem where it holds something else.

    Parameters
    ----------
    source
        The table.
    columns
        What was said about its columns: those that were named stay.
    problems
        Where problems are noted.
    """
    found = [name for name in source.schema() if _NAMES.fullmatch(name)]
    names = [name for name in found if name not in columns.named]
    notes: list[str] = []
    for name in names:
        called = f"`{name}`" if name.strip() else "A column without a name"
        if _counts_rows(source, name):
            notes.append(f"{called} numbers rows, as pandas writes them: it was left out.")
        elif not (name.strip() and columns.features):
            first = source.collect(source.frame.select(pl.col(name).head(3)))[name].to_list()
            problems.add(
                f"{called if name.strip() else 'a column'} has no name of its own and numbers no "
                f"rows; it holds {', '.join(map(str, first))} …",
                "Name it if it says something of the trials, or remove it.",
            )
    return replace(source, frame=source.frame.drop(names), notes=(*source.notes, *notes))


def _counts_rows(source: Source, name: str) -> bool:
    """Whether a column counts rows, perhaps anew for each trial, with some left out or moved.

    Times in whole milliseconds do not: most numbers between them are missing, and few follow the
    one before.
    """
    kind = source.schema()[name]
    if not (kind.is_numeric() or kind == pl.String):
        return False
    number = pl.col(name).cast(pl.Float64, strict=False)
    found = source.collect(
        source.frame.select(
            whole=((number == number.floor()).all() & number.is_not_null().all()),
            stands=((number.diff() == 0) & (number > number.min())).any(),
            dense=number.max() - number.min() < 2 * number.n_unique(),
            follows=(number.diff() == 1).mean() >= 0.5,
        )
    ).row(0, named=True)
    counts = found["dense"] or found["follows"] or found["dense"] is None  # there are no rows
    return bool(found["whole"] and not found["stands"] and counts)
