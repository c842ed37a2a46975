"""Sigma points of a mixture: where the unscented Hellinger distance looks (method 3.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.analysis.mixture import Mixture
from surmount.core.arrays import FloatArray

_TIE = 1e-6
"""Relative gap below which two axes of the frame count as not told apart by the mixture."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SigmaPoints:
    """Points and weights that stand for a mixture in integrals.

    Attributes
    ----------
    points
        Shape ``(point, feature)``.
    weights
        Component weight × sigma weight of each point, shape ``(point,)``; they sum to 1.
    """

    points: FloatArray
    weights: FloatArray


def sigma_points(mixture: Mixture) -> SigmaPoints:
    """Place 2d + 1 sigma points for each component (Kristan et al. 2011).

    With κ = max(0, 3 − d), the centre weighs κ/(d+κ) and each point at ± √(d+κ) times a column of
    a square root of the covariance weighs 1/(2(d+κ)). Points of zero weight are left out.

    The published rule leaves the square root open, and its columns turn when features are mixed.
    Here it is the Cholesky factor in axes that belong to the mixture (:func:`frame`), so that the
    points move along with the samples under any invertible affine map of the features.
    """
    d = mixture.n_features
    kappa = max(0.0, 3.0 - d)
    axes = frame(mixture)
    inverse = np.linalg.inv(axes)
    framed = inverse @ mixture.covariances @ inverse.T
    roots = axes @ np.linalg.cholesky(0.5 * (framed + framed.transpose(0, 2, 1)))
    steps = np.sqrt(d + kappa) * roots.transpose(0, 2, 1)  # (component, column, feature)
    means = mixture.means[:, None, :]
    parts = [means + steps, means - steps]
    shares = np.full(2 * d, 0.5 / (d + kappa))
    if kappa > 0.0:
        parts.append(means)
        shares = np.append(shares, kappa / (d + kappa))
    return SigmaPoints(
        points=np.concatenate(parts, axis=1).reshape(-1, d),
        weights=(mixture.weights[:, None] * shares).reshape(-1),
    )


def frame(mixture: Mixture) -> FloatArray:
    """Return axes that move along with the mixture under affine maps, as columns.

    The axes whiten the mixture's total covariance and diagonalise a mean of its components'
    covariances in which larger components weigh more, so that the mean has no symmetry that the
    components do not have. Where two axes cannot be told apart (a single component, or round
    shapes), the features' own axes are taken, so that rounding never decides.

    Returns
    -------
    FloatArray
        Shape ``(feature, feature)``, invertible.
    """
    d = mixture.n_features
    if mixture.n_components == 1:
        return np.eye(d)
    centred = mixture.means - mixture.weights @ mixture.means
    total = np.einsum("k,kij->ij", mixture.weights, mixture.covariances)
    total += (mixture.weights[:, None] * centred).T @ centred
    root = np.linalg.cholesky(total)
    inverse = np.linalg.inv(root)
    white = inverse @ mixture.covariances @ inverse.T
    sizes = np.exp(np.linalg.slogdet(white)[1] / d)
    mean = np.einsum("k,kij->ij", mixture.weights * sizes / sizes.max(), white)
    values, vectors = np.linalg.eigh(0.5 * (mean + mean.T))
    if d > 1 and np.diff(values).min() < _TIE * values[-1]:
        return np.eye(d)
    return root @ vectors
