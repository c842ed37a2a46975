r"""A random intercept per subject and a free mean per cell, fitted by REML and solved exactly.

The model is ``y = Xβ + Zu + ε`` with one column of ``X`` per cell (group × method), one column of
``Z`` per subject, ``u ~ N(0, τ)`` and ``ε ~ N(0, σ²)``. Restricted likelihood sees only what the
cell means leave over. With ``H`` the projection on ``X`` and ``ZᵀZ − ZᵀHZ = U diag(λ) Uᵀ``, those
left-over contrasts are independent with variances ``σ² + λₖτ`` (one for each positive λₖ) and
``σ²`` (the rest), so that minus twice the restricted log-likelihood is a sum of logarithms and
quotients in τ and σ². With ``ρ = τ/σ²`` the residual variance drops out, and what is left is a
smooth function of ρ ≥ 0 alone, whose derivative is searched for every root.

The same basis gives the covariance of the cell means without a matrix inverse,
``Φ = σ² D⁻¹ + Σₖ cₖ gₖgₖᵀ`` with ``cₖ = σ²τ/(σ² + λₖτ)``, where ``D`` holds the cells' counts and
``gₖ = D⁻¹XᵀZUₖ``; the docstrings below write ``s`` for σ².
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.optimize import brentq

from surmount.core.arrays import FloatArray, IntArray
from surmount.stats.columns import ROUNDING

RANK_TOLERANCE = 1e-10
"""An eigenvalue λ below this share of the largest subject's count is zero but for rounding."""

RATIO_DECADES = 30
"""ρ is searched from 10⁻³⁰/λ to 10³⁰/λ: doubles resolve ratios of variances no further."""

POINTS_PER_DECADE = 20


@dataclass(frozen=True, kw_only=True, eq=False)
class Decomposition:
    """Data of a random-intercept model in the basis in which left-over contrasts are independent.

    Attributes
    ----------
    cell_counts
        Rows in each cell, shape ``(cell,)``.
    cell_means
        Arithmetic mean of the response in each cell, shape ``(cell,)``.
    eigenvalues
        λ, ascending, exactly 0 where subjects cannot be told from cells, shape ``(subject,)``.
    directions
        gₖ as rows, shape ``(subject, cell)``.
    scores
        Left-over response along each direction, 0 where λ is, shape ``(subject,)``.
    residual_sum
        Sum of squares left over by cells and subjects together.
    residual_df
        Number of contrasts behind ``residual_sum``.
    largest
        Largest absolute response, the scale against which rounding is judged.
    """

    cell_counts: IntArray
    cell_means: FloatArray
    eigenvalues: FloatArray
    directions: FloatArray
    scores: FloatArray
    residual_sum: float
    residual_df: int
    largest: float

    @property
    def contrasts(self) -> int:
        """Number of independent contrasts left over by the cell means."""
        return self.residual_df + int((self.eigenvalues > 0).sum())


def decompose(response: FloatArray, cell: IntArray, subject: IntArray) -> Decomposition:
    """Rotate the data of a random-intercept model.

    Parameters
    ----------
    response
        Response of each row, shape ``(row,)``.
    cell, subject
        Index of each row's cell and subject, without gaps, shape ``(row,)``.
    """
    counts = np.zeros((int(subject.max()) + 1, int(cell.max()) + 1))
    np.add.at(counts, (subject, cell), 1.0)  # ZᵀX
    cell_counts, subject_counts = counts.sum(axis=0), counts.sum(axis=1)
    means = np.bincount(cell, weights=response) / cell_counts
    residual = response - means[cell]
    residual -= (np.bincount(cell, weights=residual) / cell_counts)[cell]  # clears rounding
    averaging = counts / cell_counts  # ZᵀX D⁻¹
    values, vectors = np.linalg.eigh(np.diag(subject_counts) - averaging @ counts.T)
    seen = values > RANK_TOLERANCE * subject_counts.max()
    values = np.where(seen, values, 0.0)
    directions = vectors.T @ averaging
    root = np.sqrt(np.where(seen, values, 1.0))
    totals = vectors.T @ np.bincount(subject, weights=residual)
    scores = np.where(seen, totals / root, 0.0)
    # Row-wise form of Σₖ zₖ (I − H)ZUₖ/√λₖ: what subjects explain beyond the cells.
    weight = np.where(seen, scores / root, 0.0)
    explained = (weight @ vectors.T)[subject] - (weight @ directions)[cell]
    return Decomposition(
        cell_counts=cell_counts.astype(np.int64),
        cell_means=means,
        eigenvalues=values,
        directions=directions,
        scores=scores,
        residual_sum=float(((residual - explained) ** 2).sum()),
        residual_df=int(response.size - cell_counts.size - seen.sum()),
        largest=float(np.abs(response).max()),
    )


def undefined(data: Decomposition) -> str | None:
    """Return why the two variances cannot be estimated from the data, or ``None`` if they can."""
    if data.eigenvalues.size < 2:
        return (
            "There are fewer than two networks, so the variance between networks cannot be "
            "estimated, nor how far a difference would change with another network."
        )
    if not (data.eigenvalues > 0).any():
        return (
            "Every cell holds rows of one network alone, so differences between networks cannot "
            "be told from differences between cells."
        )
    if data.residual_df < 1:
        return (
            "There are too few rows: once cells and networks are accounted for, none is left to "
            "estimate the variance within networks."
        )
    if np.sqrt(data.residual_sum / data.residual_df) <= ROUNDING * data.largest:
        return (
            "The response does not vary within networks, so there is no residual variance to "
            "compare differences with."
        )
    return None


def profile_deviance(ratio: float, data: Decomposition) -> float:
    """Return minus twice the restricted log-likelihood at a variance ratio ρ, maximised over σ².

    This is the "REML criterion" that lme4 prints (Bates et al., J. Stat. Software 67, 2015).
    """
    spread = 1.0 + ratio * data.eigenvalues
    total = data.residual_sum + float((data.scores**2 / spread).sum())
    scale = 2 * np.pi * total / data.contrasts
    return float(
        data.contrasts * (1 + np.log(scale)) + np.log(spread).sum() + np.log(data.cell_counts).sum()
    )


def _slopes(log_ratio: FloatArray, data: Decomposition) -> FloatArray:
    """Return the derivative of the profile deviance in log ρ, shape ``(ratio,)``."""
    ratio = np.exp(log_ratio)[:, None]
    spread = 1.0 + ratio * data.eigenvalues
    share = ratio * data.eigenvalues / spread
    square = data.scores**2 / spread
    total = data.residual_sum + square.sum(axis=1)
    return share.sum(axis=1) - data.contrasts * (square * share).sum(axis=1) / total


def _slope(log_ratio: float, data: Decomposition) -> float:
    return float(_slopes(np.array([log_ratio]), data)[0])


def best_ratio(data: Decomposition) -> float:
    """Return the variance ratio ρ = τ/σ² that maximises the restricted likelihood.

    Every sign change of the derivative on a fine grid in log ρ is a candidate, and so is the
    boundary ρ = 0, which is returned where no network effect fits better than none.
    """
    seen = data.eigenvalues[data.eigenvalues > 0]
    low = np.log(10.0) * -RATIO_DECADES - np.log(seen.max())
    high = np.log(10.0) * RATIO_DECADES - np.log(seen.min())
    grid = np.linspace(low, high, int((high - low) / np.log(10.0) * POINTS_PER_DECADE) + 1)
    slopes = _slopes(grid, data)
    rising = np.flatnonzero((slopes[:-1] < 0) & (slopes[1:] >= 0))
    candidates = [0.0]
    for index in rising:
        low, high = float(grid[index]), float(grid[index + 1])
        root = cast(float, brentq(_slope, low, high, args=(data,), xtol=1e-14))
        candidates.append(float(np.exp(root)))
    return min(candidates, key=lambda ratio: profile_deviance(ratio, data))


@dataclass(frozen=True, kw_only=True, eq=False)
class RandomInterceptFit:
    """A fitted random-intercept model.

    Attributes
    ----------
    data
        What was fitted.
    ratio
        ρ = τ/σ², 0 on the boundary.
    residual_variance, subject_variance
        σ² and τ, in squared units of the response.
    criterion
        Minus twice the restricted log-likelihood at the estimate.
    means
        Generalised least-squares mean of each cell, shape ``(cell,)``.
    """

    data: Decomposition
    ratio: float
    residual_variance: float
    subject_variance: float
    criterion: float
    means: FloatArray


def fit(data: Decomposition) -> RandomInterceptFit:
    """Fit by REML data for which :func:`undefined` has no objection."""
    ratio = best_ratio(data)
    spread = 1.0 + ratio * data.eigenvalues
    total = data.residual_sum + float((data.scores**2 / spread).sum())
    variance = total / data.contrasts
    # Predicted intercepts in the basis U: ρ √λ z / (1 + ρλ); the cells' share of them is removed.
    intercepts = ratio * np.sqrt(data.eigenvalues) * data.scores / spread
    return RandomInterceptFit(
        data=data,
        ratio=ratio,
        residual_variance=variance,
        subject_variance=ratio * variance,
        criterion=profile_deviance(ratio, data),
        means=data.cell_means - intercepts @ data.directions,
    )
