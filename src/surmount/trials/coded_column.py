"""Columns with few distinct entries, held as small integers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surmount.core.arrays import FloatArray

CodeArray = NDArray[np.int32]

_PIECE_ROWS = 100_000


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


def coded_combinations(columns: Sequence[FloatArray]) -> Coded:
    """Return the distinct combinations of several columns in ascending order."""
    first, *others = (coded(column.__getitem__, column.size) for column in columns)
    variants = Coded(distinct=first.distinct[:, None], code=first.code)
    for other in others:
        pairs = variants.paired(other)
        known, added = pairs.distinct.T
        distinct = np.column_stack([variants.distinct[known], other.distinct[added]])
        variants = Coded(distinct=distinct, code=pairs.code)
    return variants
