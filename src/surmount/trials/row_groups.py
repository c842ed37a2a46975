"""Which rows of a table are one trial: those that agree in variant, network and trial."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl

from surmount.core.arrays import IntArray


@dataclass(frozen=True, kw_only=True, eq=False)
class RowGroups:
    """The trials of a table, in the order of their first rows.

    Attributes
    ----------
    ids
        Variant, network and trial of each, as columns of one entry per trial.
    first
        First row of each, from 0, shape ``(trial,)``.
    trial
        Trial of each row, shape ``(row,)``.
    starts
        Where each begins once the rows of a trial stand together, shape ``(trial + 1,)``.
    order
        Rows in this order, shape ``(row,)``; ``None`` where they stand together already.
    """

    ids: pl.DataFrame
    first: IntArray
    trial: np.ndarray[Any, np.dtype[np.int32]]
    starts: IntArray
    order: IntArray | None

    @property
    def n_trials(self) -> int:
        """Number of trials."""
        return int(self.first.size)

    @property
    def lengths(self) -> IntArray:
        """Rows of each trial, shape ``(trial,)``."""
        return np.diff(self.starts)

    def ordered(self, column: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        """Return a column with the rows of each trial together."""
        return column if self.order is None else column[self.order]

    def row_of(self, places: IntArray) -> IntArray:
        """Return which rows, from 0, stand at places of this order."""
        return places if self.order is None else self.order[places]


def group_rows(ids: pl.DataFrame) -> RowGroups:
    """Group rows that agree in all columns, which have no gaps."""
    names = ids.columns
    runs = ids.select(pl.struct(names).rle().alias("run")).unnest("run").unnest("value")
    length = runs.drop_in_place("len").to_numpy().astype(np.int64)
    begin = np.cumsum(length) - length
    runs = runs.with_columns(begin=pl.Series(begin))
    trials = runs.group_by(names, maintain_order=True).agg(pl.col("begin").first())
    numbered = trials.with_row_index("number").drop("begin")
    number = runs.join(numbered, on=names, how="left", maintain_order="left")["number"].to_numpy()
    trial = np.repeat(number.astype(np.int32), length)
    counts = np.bincount(trial, minlength=trials.height)
    order = None
    if runs.height > trials.height:
        order = np.argsort(trial, kind="stable")
    return RowGroups(
        ids=trials.drop("begin"),
        first=trials["begin"].to_numpy().astype(np.int64),
        trial=trial,
        starts=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        order=order,
    )
