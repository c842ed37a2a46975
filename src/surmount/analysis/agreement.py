"""How far two groupings of the same variants agree."""

from __future__ import annotations

import numpy as np

from surmount.core.arrays import FloatArray, IntArray


def adjusted_rand(first: IntArray, second: IntArray) -> float:
    """Return the adjusted Rand index of two groupings (Hubert & Arabie 1985).

    1 means the same grouping, 0 the agreement expected by chance. Two groupings that are both
    trivial in the same way agree fully.

    Parameters
    ----------
    first, second
        Group of each variant, shape ``(variant,)``.
    """
    _, a = np.unique(first, return_inverse=True)
    _, b = np.unique(second, return_inverse=True)
    table = np.zeros((a.max() + 1, b.max() + 1))
    np.add.at(table, (a, b), 1.0)
    together = _pairs(table)
    in_first, in_second = _pairs(table.sum(axis=1)), _pairs(table.sum(axis=0))
    everything = a.size * (a.size - 1) / 2.0
    if everything == 0.0:
        return 1.0
    expected = in_first * in_second / everything
    most = 0.5 * (in_first + in_second)
    return 1.0 if most == expected else float((together - expected) / (most - expected))


def _pairs(counts: FloatArray) -> float:
    return float((counts * (counts - 1.0) / 2.0).sum())
