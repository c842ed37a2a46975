"""Starts for expectation-maximisation: k-means++ centres and a few of Lloyd's iterations."""

from __future__ import annotations

import numpy as np

from surmount.analysis.expectation_maximisation import Components
from surmount.core.arrays import FloatArray, IntArray

_LLOYD_ITERATIONS = 10


def spread_centres(x: FloatArray, n_centres: int, rng: np.random.Generator) -> FloatArray:
    """Choose centres among the samples by k-means++ (Arthur & Vassilvitskii 2007).

    Parameters
    ----------
    x
        Samples, shape ``(sample, feature)``.
    n_centres
        Centres wanted.
    rng
        Source of randomness.

    Returns
    -------
    FloatArray
        Shape ``(centre, feature)``; fewer than wanted where there are fewer distinct samples.
    """
    centres = [x[int(rng.integers(x.shape[0]))]]
    nearest = np.square(x - centres[0]).sum(axis=1)
    for _ in range(n_centres - 1):
        cumulative = np.cumsum(nearest)
        if cumulative[-1] <= 0.0:
            break
        position = rng.random() * cumulative[-1]
        chosen = min(int(np.searchsorted(cumulative, position, side="right")), x.shape[0] - 1)
        centres.append(x[chosen])
        np.minimum(nearest, np.square(x - x[chosen]).sum(axis=1), out=nearest)
    return np.asarray(centres)


def nearest_centre(x: FloatArray, centres: FloatArray) -> IntArray:
    """Return the index of the centre nearest to each sample, shape ``(sample,)``."""
    # |x − c|² without |x|², which is the same for all centres.
    scores = np.square(centres).sum(axis=1) - 2.0 * (x @ centres.T)
    return np.argmin(scores, axis=1).astype(np.int64)


def start_components(
    x: FloatArray, n_components: int, regularisation: float, rng: np.random.Generator
) -> Components:
    """Return a start: clusters of samples around k-means++ centres, as Gaussians.

    Parameters
    ----------
    x
        Standardised samples, shape ``(sample, feature)``.
    n_components
        Components wanted; fewer come back where clusters run empty.
    regularisation
        Variance added to the diagonal of each covariance.
    rng
        Source of randomness.
    """
    centres = spread_centres(x, n_components, rng)
    labels = nearest_centre(x, centres)
    for _ in range(_LLOYD_ITERATIONS):
        sums, counts = _cluster_sums(x, labels, centres.shape[0])
        filled = counts > 0
        centres = sums[filled] / counts[filled, None]
        updated = nearest_centre(x, centres)
        if filled.all() and np.array_equal(updated, labels):
            break
        labels = updated
    return _gaussians(x, labels, centres.shape[0], regularisation)


def _cluster_sums(
    x: FloatArray, labels: IntArray, n_clusters: int
) -> tuple[FloatArray, FloatArray]:
    counts = np.bincount(labels, minlength=n_clusters)
    sums = np.stack(
        [np.bincount(labels, weights=column, minlength=n_clusters) for column in x.T], axis=1
    )
    return np.asarray(sums, dtype=np.float64), counts.astype(np.float64)


def _gaussians(
    x: FloatArray, labels: IntArray, n_clusters: int, regularisation: float
) -> Components:
    n_features = x.shape[1]
    sums, counts = _cluster_sums(x, labels, n_clusters)
    filled = counts > 0
    means = np.where(filled[:, None], sums / np.maximum(counts, 1.0)[:, None], 0.0)
    centred = x - means[labels]
    products = (centred[:, :, None] * centred[:, None, :]).reshape(x.shape[0], -1)
    moments, _ = _cluster_sums(products, labels, n_clusters)
    covariances = moments.reshape(n_clusters, n_features, n_features)
    covariances = covariances[filled] / counts[filled, None, None]
    covariances += regularisation * np.eye(n_features)
    return Components(
        weights=counts[filled] / counts.sum(), means=means[filled], covariances=covariances
    )
