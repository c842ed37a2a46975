"""Hellinger distance between mixtures (paper eq. 1), by the unscented estimate.

With the importance density p₀ = ½(p + q) and r = q/p, the integrand of D² = ½∫(√p − √q)² dx is
½(√p − √q)²/p₀ = (1 − √r)²/(1 + r), which lies in [0, 1] and does not change when p and q are
swapped. D² is its mean over the sigma points of p₀, half of them from p and half from q.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surmount.analysis.expectation_maximisation import Components, coefficients, expand
from surmount.analysis.mixture import Mixture
from surmount.analysis.sigma_points import sigma_points
from surmount.analysis.threads import LARGEST_PRODUCT
from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import InputError

_LARGEST_SQUARE = 1e9
"""Squares up to this leave 1e-7 nats of rounding in the fast form of the densities."""


def hellinger(p: Mixture, q: Mixture) -> float:
    """Return the unscented Hellinger distance of two mixtures, in [0, 1].

    It is the same number for ``(q, p)``, to the last bit, and exactly 0 from a mixture to itself.
    Rounding depends on the place of a component among all that are evaluated at once, so the two
    mixtures always take the same places, whichever comes first.

    Parameters
    ----------
    p, q
        Mixtures over the same features, in the same units.

    Raises
    ------
    InputError
        If the mixtures have different numbers of features.
    """
    one, other = _numbers(p), _numbers(q)
    if one == other:
        return 0.0
    return float(hellinger_matrix([p, q] if one < other else [q, p])[0, 1])


def hellinger_matrix(mixtures: Sequence[Mixture]) -> FloatArray:
    """Return the unscented Hellinger distances of all pairs of mixtures.

    The matrix is symmetric to the last bit. Among other mixtures a pair rounds otherwise than
    alone in :func:`hellinger`: squared distances differed by 2e-13 at most over 800 random pairs.

    Beside the result, memory is one tile of densities (at most 1 MiB, or one pair of mixtures) and
    copies of all components, some 60 d² bytes each: 1 kB over 4 features.

    Parameters
    ----------
    mixtures
        Mixtures over the same features, in the same units.

    Returns
    -------
    FloatArray
        Shape ``(mixture, mixture)``; symmetric, in [0, 1], zero on the diagonal.

    Raises
    ------
    InputError
        If there is no mixture, or they have different numbers of features.
    """
    features = {mixture.n_features for mixture in mixtures}
    if len(features) != 1:
        raise InputError(
            f"Distances need mixtures over the same features, not over {sorted(features)} "
            "features.",
            remedy="Fit all mixtures to the same features.",
        )
    standard = _standardised(mixtures)
    evaluate = _Densities(standard)
    half = np.empty((len(mixtures), len(mixtures)))
    for row, mixture in enumerate(standard):
        sigma = sigma_points(mixture)
        half[row] = evaluate.divergences(row, sigma.points, sigma.weights)
    for row in range(len(mixtures)):  # in place: whole copies would take twice the result
        squared = 0.5 * (half[row, row:] + half[row:, row])
        half[row, row:] = half[row:, row] = np.sqrt(np.clip(squared, 0.0, 1.0))
    np.fill_diagonal(half, 0.0)
    return half


class _Densities:
    """All components of all mixtures side by side, to be evaluated at one mixture's points."""

    def __init__(self, mixtures: Sequence[Mixture]) -> None:
        self._sizes = np.asarray([mixture.n_components for mixture in mixtures])
        self._first = np.concatenate([[0], np.cumsum(self._sizes)]).astype(np.int64)
        self._components = Components(
            weights=np.concatenate([mixture.weights for mixture in mixtures]),
            means=np.concatenate([mixture.means for mixture in mixtures]),
            covariances=np.concatenate([mixture.covariances for mixture in mixtures]),
        )
        smallest = np.linalg.eigvalsh(self._components.covariances)[:, 0].min()
        reach = np.square(self._components.means).sum(axis=1).max()
        self._fast = bool(reach < _LARGEST_SQUARE * smallest)
        self._matrix = coefficients(self._components)
        self._whitening = np.linalg.inv(np.linalg.cholesky(self._components.covariances))

    def divergences(self, own: int, points: FloatArray, weights: FloatArray) -> FloatArray:
        """Return Σ weight · (1 − √r)²/(1 + r) with r = density / own density, ``(mixture,)``."""
        phi = expand(points)
        n_mixtures = self._sizes.size
        result = np.empty(n_mixtures)
        logits = self._logits(slice(self._first[own], self._first[own + 1]), phi)
        top = logits.max(axis=0)
        own_density = top + np.log(np.exp(logits - top).sum(axis=0))
        per_tile = max(1, LARGEST_PRODUCT // phi.size)
        start = 0
        with np.errstate(over="ignore"):
            while start < n_mixtures:
                stop = int(np.searchsorted(self._first, self._first[start] + per_tile, "right")) - 1
                stop = min(max(stop, start + 1), n_mixtures)
                tile = slice(self._first[start], self._first[stop])
                logits = self._logits(tile, phi)
                logits -= own_density
                np.exp(logits, out=logits)
                ratio = _segment_sums(logits, self._first[start : stop + 1] - self._first[start])
                np.minimum(ratio, 1e300, out=ratio)
                root = np.sqrt(ratio)
                result[start:stop] = (np.square(1.0 - root) / (1.0 + ratio)) @ weights
                start = stop
        return result

    def _logits(self, tile: slice, phi: FloatArray) -> FloatArray:
        """Return log weighted densities of a range of components, ``(component, point)``."""
        if self._fast:
            return self._matrix[tile] @ phi.T
        # Narrow components far from the origin: whiten differences before squaring.
        d = self._components.means.shape[1]
        whitening, means = self._whitening[tile], self._components.means[tile]
        offsets = np.einsum("kij,kj->ki", whitening, means)
        white = whitening @ phi[:, 1 : 1 + d].T - offsets[:, :, None]
        log_scale = (
            np.log(self._components.weights[tile])
            + np.log(np.diagonal(whitening, axis1=1, axis2=2)).sum(axis=1)
            - 0.5 * d * np.log(2.0 * np.pi)
        )
        return log_scale[:, None] - 0.5 * np.square(white).sum(axis=1)


def _segment_sums(values: FloatArray, first: IntArray) -> FloatArray:
    """Return sums of consecutive rows; ``first`` holds the start of each segment and the end."""
    sizes = np.diff(first)
    if (sizes == sizes[0]).all():
        return values.reshape(sizes.size, sizes[0], -1).sum(axis=1)
    return np.add.reduceat(values, first[:-1], axis=0)


def _numbers(mixture: Mixture) -> list[list[float]]:
    """Return all that a mixture's density depends on, as lists: these can be put in order."""
    return [part.ravel().tolist() for part in (mixture.weights, mixture.means, mixture.covariances)]


def _standardised(mixtures: Sequence[Mixture]) -> list[Mixture]:
    """Shift and scale all mixtures alike, which leaves the distance unchanged."""
    means = np.stack([mixture.weights @ mixture.means for mixture in mixtures])
    centre = means.mean(axis=0)
    second = [
        mixture.weights
        @ (np.square(mixture.means - centre) + np.diagonal(mixture.covariances, axis1=1, axis2=2))
        for mixture in mixtures
    ]
    scale = np.sqrt(np.mean(second, axis=0))
    return [
        Mixture(
            weights=mixture.weights,
            means=(mixture.means - centre) / scale,
            covariances=mixture.covariances / (scale[:, None] * scale),
            fit=mixture.fit,
        )
        for mixture in mixtures
    ]
