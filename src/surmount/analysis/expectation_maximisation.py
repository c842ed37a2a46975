"""Expectation-maximisation for full-covariance mixtures (paper eq. 2) as two matrix products.

The log density of a Gaussian is linear in the expanded features φ(x) = (1, xᵢ, xᵢxⱼ for i ≤ j).
The log densities of all components at all samples are therefore one product of φ with a matrix of
coefficients, and all sums of the maximisation (mass, first and second moments of every component)
are one product of the responsibilities with φ. There is no loop over components. Samples go
through in blocks that stay in the cache; threads take pieces of several blocks, whose sums are
added in a fixed order, so that nothing depends on the number of threads.

Samples must be standardised: squares of features are subtracted from each other, which loses
about ``(|x| / smallest standard deviation)² · 1e-16`` nats; the regularisation bounds this ratio.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from surmount.analysis.threads import LARGEST_PRODUCT, spread, threads_kept
from surmount.core.arrays import FloatArray, IntArray

_FEWEST_ROWS, _MOST_ROWS, _ROW_STEP = 256, 4096, 64
"""Samples per block: few enough for the cache, enough to make calls worth their overhead."""
_PIECE_VALUES = 1 << 17
"""Logits of a piece, a thread's unit of work: about half a millisecond."""
_FEWEST_PIECES = 4
"""Fewer are not worth waking threads for."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Components:
    """Parameters of a mixture during a fit, shapes as in ``analysis.mixture.Mixture``."""

    weights: FloatArray
    means: FloatArray
    covariances: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """Where expectation-maximisation ended.

    Attributes
    ----------
    components
        The parameters.
    log_likelihood
        Their log-likelihood over all samples in nats, in units of the samples given.
    n_samples
        Samples, each as often as it counts.
    iterations
        Maximisations done.
    converged
        Whether the mean gain per sample fell below the tolerance.
    collapsed
        Components removed on the way.
    """

    components: Components
    log_likelihood: float
    n_samples: int
    iterations: int
    converged: bool
    collapsed: int


@lru_cache(maxsize=16)
def feature_pairs(n_features: int) -> tuple[IntArray, IntArray]:
    """Return the index pairs i ≤ j in the order of the expanded features."""
    rows, columns = np.triu_indices(n_features)
    rows.setflags(write=False)
    columns.setflags(write=False)
    return rows, columns


def expand(x: FloatArray) -> FloatArray:
    """Return φ(x) = (1, xᵢ, xᵢxⱼ for i ≤ j), shape ``(sample, 1 + d + d(d+1)/2)``."""
    n, d = x.shape
    phi = np.empty((n, 1 + d + d * (d + 1) // 2))
    phi[:, 0] = 1.0
    phi[:, 1 : 1 + d] = x
    rows, columns = feature_pairs(d)
    np.multiply(x[:, rows], x[:, columns], out=phi[:, 1 + d :])
    return phi


def coefficients(components: Components) -> FloatArray:
    """Return the matrix whose product with φ(x) is ln wₖ + ln N(x; μₖ, Σₖ).

    Returns
    -------
    FloatArray
        Shape ``(component, 1 + d + d(d+1)/2)``.
    """
    means = components.means
    d = means.shape[1]
    factors = np.linalg.cholesky(components.covariances)
    inverse = np.linalg.inv(factors)
    precision = inverse.transpose(0, 2, 1) @ inverse
    slope = np.einsum("kij,kj->ki", precision, means)
    log_root = np.log(np.diagonal(factors, axis1=1, axis2=2)).sum(axis=1)
    rows, columns = feature_pairs(d)
    result = np.empty((means.shape[0], 1 + d + rows.size))
    result[:, 0] = (
        np.log(components.weights)
        - 0.5 * (d * math.log(2.0 * math.pi) + (slope * means).sum(axis=1))
        - log_root
    )
    result[:, 1 : 1 + d] = slope
    result[:, 1 + d :] = precision[:, rows, columns] * np.where(rows == columns, -0.5, -1.0)
    return result


def expectation(
    phi: FloatArray, components: Components, sample_weights: FloatArray | None = None
) -> tuple[float, FloatArray]:
    """Return the log-likelihood and the sums that the maximisation needs.

    Parameters
    ----------
    phi
        Expanded features, shape ``(sample, expanded)``.
    components
        Parameters.
    sample_weights
        How often each sample counts, shape ``(sample,)``; once where absent.

    Returns
    -------
    tuple
        Log-likelihood in nats; Σ over samples of responsibility × φ, ``(component, expanded)``.
    """
    matrix = coefficients(components)

    def of_piece(piece: tuple[slice, int]) -> tuple[float, FloatArray]:
        samples, rows = piece
        blocks = phi[samples].reshape(-1, rows, phi.shape[1])
        if sample_weights is None:
            return _sums(blocks, matrix, None)
        return _sums(blocks, matrix, sample_weights[samples].reshape(-1, 1, rows))

    pieces = _pieces(phi.shape[0], *matrix.shape)
    found = spread(of_piece, pieces) if len(pieces) >= _FEWEST_PIECES else map(of_piece, pieces)
    log_likelihood, sums = 0.0, np.zeros_like(matrix)
    for value, part in found:
        log_likelihood += value
        sums += part
    return log_likelihood, sums


def _pieces(n_samples: int, n_components: int, n_expanded: int) -> list[tuple[slice, int]]:
    """Divide samples into pieces of whole blocks; the last samples are a piece of one block.

    Returns
    -------
    list of tuple
        The samples of each piece, and the samples in each of its blocks: as many as BLAS
        multiplies in the calling thread.
    """
    fitting = LARGEST_PRODUCT // (n_components * n_expanded) // _ROW_STEP * _ROW_STEP
    rows = min(max(fitting, _FEWEST_ROWS), _MOST_ROWS)
    per_piece = rows * max(1, _PIECE_VALUES // (rows * n_components))
    whole = n_samples // rows * rows
    pieces = [
        (slice(start, min(start + per_piece, whole)), rows) for start in range(0, whole, per_piece)
    ]
    if whole < n_samples:
        pieces.append((slice(whole, n_samples), n_samples - whole))
    return pieces


def _sums(
    blocks: FloatArray, matrix: FloatArray, counts: FloatArray | None
) -> tuple[float, FloatArray]:
    """Return log-likelihood and Σ responsibility × φ of blocks, ``(block, sample, expanded)``."""
    logits = matrix @ blocks.transpose(0, 2, 1)
    top = logits.max(axis=1, keepdims=True)
    logits -= top
    np.exp(logits, out=logits)
    total = logits.sum(axis=1, keepdims=True)
    densities = top + np.log(total)
    if counts is None:
        logits /= total
    else:
        logits *= counts / total
        densities *= counts
    return float(densities.sum()), (logits @ blocks).sum(axis=0)


def maximisation(sums: FloatArray, n_features: int, regularisation: float) -> Components:
    """Return the parameters that maximise the expected log-likelihood, covariances regularised.

    Parameters
    ----------
    sums
        From :func:`expectation`; every component must have positive mass.
    n_features
        Number of features d.
    regularisation
        Variance added to the diagonal of each covariance.
    """
    mass = sums[:, 0]
    means = sums[:, 1 : 1 + n_features] / mass[:, None]
    rows, columns = feature_pairs(n_features)
    covariances = np.empty((mass.size, n_features, n_features))
    moments = sums[:, 1 + n_features :] / mass[:, None] - means[:, rows] * means[:, columns]
    covariances[:, rows, columns] = moments
    covariances[:, columns, rows] = moments
    # Rounding may leave a variance a hair below zero where a component is a single point.
    diagonal = np.arange(n_features)
    variances = np.maximum(covariances[:, diagonal, diagonal], 0.0)
    covariances[:, diagonal, diagonal] = variances + regularisation
    return Components(weights=mass / mass.sum(), means=means, covariances=covariances)


@threads_kept()
def maximise_likelihood(
    phi: FloatArray,
    start: Components,
    *,
    regularisation: float,
    tolerance: float,
    max_iterations: int,
    sample_weights: FloatArray | None = None,
) -> Fit:
    """Iterate expectation and maximisation from a start.

    A component left with fewer than d + 1 samples cannot hold a covariance: it is removed and
    counted, and the others go on.

    Parameters
    ----------
    phi
        Expanded standardised samples, shape ``(sample, expanded)``.
    start
        Where to begin.
    regularisation, tolerance, max_iterations
        As in :class:`surmount.analysis.configuration.AnalysisConfig`.
    sample_weights
        How often each sample counts; once where absent.
    """
    components, collapsed = start, 0
    n_features = start.means.shape[1]
    n_samples = phi.shape[0] if sample_weights is None else float(sample_weights.sum())
    smallest_mass = min(n_features + 1.0, 0.5 * n_samples)
    previous = -math.inf
    for iteration in range(max_iterations + 1):
        log_likelihood, sums = expectation(phi, components, sample_weights)
        kept = sums[:, 0] >= smallest_mass
        converged = abs(log_likelihood - previous) < tolerance * n_samples and bool(kept.all())
        if converged or iteration == max_iterations:
            return Fit(
                components=components,
                log_likelihood=log_likelihood,
                n_samples=round(n_samples),
                iterations=iteration,
                converged=converged,
                collapsed=collapsed,
            )
        if not kept.all():
            if not kept.any():
                kept = sums[:, 0] == sums[:, 0].max()
            collapsed += int((~kept).sum())
            sums = sums[kept]
        previous = log_likelihood
        components = maximisation(sums, n_features, regularisation)
    raise AssertionError("unreachable: the loop returns at its last iteration")
