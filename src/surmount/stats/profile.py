"""Performance profiles: what share of scores lies above each threshold (Agarwal et al. 2021)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import FloatArray
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.columns import numbers
from surmount.stats.result import Result
from surmount.stats.strata import Scores, drawn, read_strata, sizes, too_few

THRESHOLDS = np.linspace(0.0, 1.0, 101)[:-1]
"""Success rates to exceed; nothing exceeds 1."""


@dataclass(frozen=True, kw_only=True)
class PerformanceProfile(Result):
    """Share of (network, variant) pairs that score above each threshold.

    Attributes
    ----------
    thresholds, share
        Thresholds, and the share of scores strictly above each.
    lower, upper
        Pointwise limits over networks, ``None`` throughout where undefined.
    confidence, resamples, n_networks, reason
        As in :class:`surmount.stats.SeedInterval`.
    """

    thresholds: tuple[float, ...]
    share: tuple[float, ...]
    lower: tuple[float | None, ...]
    upper: tuple[float | None, ...]
    confidence: float
    resamples: int
    n_networks: tuple[int, ...]
    reason: str | None


def performance_profile(
    scores: Scores, thresholds: npt.ArrayLike, bootstrap: Bootstrap
) -> PerformanceProfile:
    """Return the share of scores above each threshold, with pointwise limits over networks.

    Parameters
    ----------
    scores
        As in :func:`surmount.stats.bootstrap_interval`.
    thresholds
        Scores to exceed, shape ``(threshold,)``.
    bootstrap
        How networks are redrawn.
    """
    strata = read_strata(scores, "scores")
    heights = numbers(thresholds, "thresholds")
    above = {  # variants above each threshold, by network: (network, threshold)
        key: (matrix[:, :, None] > heights).sum(axis=1, dtype=np.float64)
        for key, matrix in strata.items()
    }
    count = sum(matrix.size for matrix in strata.values())
    reason = too_few(strata)
    lower: tuple[float | None, ...] = (None,) * heights.size
    upper = lower
    if reason is None:

        def draw(rng: np.random.Generator) -> FloatArray:
            rows = drawn(strata, rng)
            parts = [matrix[rows[key]].sum(axis=0) for key, matrix in above.items()]
            return np.sum(parts, axis=0) / count

        low, high = bootstrap.limits(draw)
        lower, upper = tuple(low.tolist()), tuple(high.tolist())
    share = np.sum([matrix.sum(axis=0) for matrix in above.values()], axis=0) / count
    return PerformanceProfile(
        thresholds=tuple(heights.tolist()),
        share=tuple(share.tolist()),
        lower=lower,
        upper=upper,
        confidence=bootstrap.confidence,
        resamples=bootstrap.resamples,
        n_networks=sizes(strata),
        reason=reason,
    )
