"""What every form of a table of trials becomes before it is read: columns that Polars can scan."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import polars as pl

from surmount.core.errors import InputError

MOST_ROWS = 2**31 - 1
"""Rows are numbered in 32 bits."""
_BYTES_PER_ENTRY = 8
POLARS_ERRORS: tuple[type[BaseException], ...] = (
    pl.exceptions.PolarsError,
    pl.exceptions.PanicException,
)


def _row_number(row: int) -> str:
    return str(row + 1)


def _nothing_more_is_known() -> None:
    """Raise nothing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Source:
    """A table whose columns have been found, and not been read.

    Attributes
    ----------
    name
        How errors name it.
    frame
        Its columns as they are; those of text files are all text.
    place
        How a row, counted from 0, is called: by its number, or with its file.
    decimal_commas
        Whether numbers may have commas for decimals, because columns are separated otherwise.
    told
        Columns that do not stand in it but in names of files, or in a table beside.
    notes
        What was left out while it was opened, in sentences.
    axes
        What it says itself of the axes of task parameters, in JSON form by parameter.
    explain
        Looks for what is wrong where Polars cannot read it, and raises it.
    """

    name: str
    frame: pl.LazyFrame
    place: Callable[[int], str] = _row_number
    decimal_commas: bool = False
    told: frozenset[str] = frozenset()
    notes: tuple[str, ...] = ()
    axes: Mapping[str, Any] = field(default_factory=dict[str, Any])
    explain: Callable[[], None] = _nothing_more_is_known

    def schema(self) -> dict[str, Any]:
        """Return the type of each column."""
        with self._sentences():
            return dict(self.frame.collect_schema())

    def collect(self, frame: pl.LazyFrame) -> pl.DataFrame:
        """Compute columns made from :attr:`frame` piece by piece: text is never held whole."""
        with self._sentences():
            return frame.collect(engine="streaming")

    @contextmanager
    def _sentences(self) -> Generator[None]:
        try:
            yield
        except (OSError, *POLARS_ERRORS) as error:
            self.explain()
            raise InputError(
                f"{self.name} cannot be read as a table: it is damaged, or no table.",
                remedy="Write the file again, or look how it was copied.",
            ) from error


def require_memory(name: str, n_rows: int, n_columns: int) -> None:
    """Refuse a table that cannot fit: a few bytes of Parquet can stand for billions of rows."""
    needed = _BYTES_PER_ENTRY * n_rows * n_columns
    present = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if n_rows > MOST_ROWS or needed > present:
        raise InputError(
            f"{name} holds {n_rows:,} rows of {n_columns:,} columns: {needed / 1e9:,.0f} GB, and "
            f"this machine has {present / 1e9:,.0f} GB.",
            remedy="Log fewer steps or features, or use a machine with more memory.",
        )
