"""Gaussian mixtures: the record of how one variant is behaved on, and its density."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.core.reading import read_as

_BLOCK_VALUES = 1 << 18
"""Values of the largest temporary array of a density call: 2 MiB, which stays in the cache."""


@dataclass(frozen=True, kw_only=True)
class FitReport:
    """How a fit went: part of the result, whether it went well or not.

    Attributes
    ----------
    n_samples
        Samples that the mixture was fitted to.
    log_likelihood
        Log-likelihood of these samples in nats, with densities in the features' own units.
    converged
        Whether the gain per iteration fell below the tolerance before the iterations ran out.
    iterations
        Iterations of expectation-maximisation from the chosen start.
    restarts
        Starts that were tried.
    requested
        Components that were asked for.
    collapsed
        Components removed because fewer samples were left to them than a covariance needs.
    floored
        Components with a standard deviation that only the regularisation keeps from vanishing.
    """

    n_samples: int
    log_likelihood: float
    converged: bool
    iterations: int
    restarts: int
    requested: int
    collapsed: int
    floored: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Mixture:
    """A mixture of Gaussians with full covariances (paper eq. 2).

    Attributes
    ----------
    weights
        Probability of each component, shape ``(component,)``; positive, summing to 1.
    means
        Shape ``(component, feature)``, in the features' units.
    covariances
        Shape ``(component, feature, feature)``; symmetric and positive definite.
    fit
        How the fit went; ``None`` for a mixture that was not fitted.

    Raises
    ------
    InputError
        If shapes do not fit, a value is not finite, weights are not positive with sum 1, or a
        covariance is not symmetric and positive definite.
    """

    weights: FloatArray
    means: FloatArray
    covariances: FloatArray
    fit: FitReport | None = None

    def __post_init__(self) -> None:
        problem = _problem(self.weights, self.means, self.covariances)
        if problem is not None:
            raise InputError(f"Mixture: {problem[0]}", remedy=problem[1])

    @property
    def n_components(self) -> int:
        """Number of components."""
        return int(self.weights.size)

    @property
    def n_features(self) -> int:
        """Number of features."""
        return int(self.means.shape[1])

    @property
    def n_parameters(self) -> int:
        """Free parameters T of eq. 3: K−1 weights, K·m means, K·m(m+1)/2 covariances."""
        return free_parameters(self.n_components, self.n_features)

    @property
    def converged(self) -> bool:
        """Whether the fit converged; ``False`` for a mixture that was not fitted."""
        return self.fit is not None and self.fit.converged

    @property
    def bic(self) -> float:
        """Bayesian information criterion −2L + T ln N of the fit (eq. 3), lower is better."""
        if self.fit is None:
            raise InputError(
                "This mixture was not fitted to samples, so it has no BIC.",
                remedy="Use a mixture returned by `surmount.fit_mixture`.",
            )
        return bic(self.fit.log_likelihood, self.fit.n_samples, self.n_components, self.n_features)

    def log_density(self, x: FloatArray) -> FloatArray:
        """Return the log density in nats at points.

        Parameters
        ----------
        x
            Points in the features' units, shape ``(sample, feature)``, or one point.

        Returns
        -------
        FloatArray
            Shape ``(sample,)``; ``-inf`` never occurs for finite points.
        """
        points = np.atleast_2d(np.asarray(x, dtype=np.float64))
        if points.ndim != 2 or points.shape[1] != self.n_features:
            raise InputError(
                f"Points of shape {points.shape} do not fit a mixture over "
                f"{self.n_features} features.",
                remedy="Give one row per point and one column per feature.",
            )
        if not np.isfinite(points).all():
            raise InputError("Points hold NaN or infinite values.", remedy="Drop those rows.")
        return log_density(self.weights, self.means, self.covariances, points)

    def sample(self, rng: np.random.Generator, size: int) -> FloatArray:
        """Draw ``size`` points, shape ``(size, feature)``."""
        component = rng.choice(self.n_components, size=size, p=self.weights)
        factors = np.linalg.cholesky(self.covariances)
        noise = rng.standard_normal((size, self.n_features))
        return self.means[component] + np.einsum("nij,nj->ni", factors[component], noise)

    def to_record(self) -> dict[str, Any]:
        """Return the JSON form."""
        return {
            "weights": self.weights.tolist(),
            "means": self.means.tolist(),
            "covariances": self.covariances.tolist(),
            "fit": None if self.fit is None else asdict(self.fit),
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> Mixture:
        """Build from the JSON form, with the checks of the constructor."""
        try:
            return read_as(cls, record)
        except ValueError as error:
            raise InputError(
                f"A mixture record is incomplete or malformed ({error}).",
                remedy="Use a file that Surmount wrote.",
            ) from error


def free_parameters(n_components: int, n_features: int) -> int:
    """Return T of eq. 3, the number of free parameters of a full-covariance mixture."""
    per_component = n_features + n_features * (n_features + 1) // 2
    return n_components - 1 + n_components * per_component


def bic(log_likelihood: float, n_samples: int, n_components: int, n_features: int) -> float:
    """Return −2L + T ln N (eq. 3)."""
    return -2.0 * log_likelihood + free_parameters(n_components, n_features) * math.log(n_samples)


def log_density(
    weights: FloatArray, means: FloatArray, covariances: FloatArray, x: FloatArray
) -> FloatArray:
    """Return the log density of a mixture at points, by whitening with Cholesky factors.

    Whitened differences are formed before squaring, so that nothing cancels however narrow the
    components are; memory stays bounded for any number of points.

    Parameters
    ----------
    weights, means, covariances
        As in :class:`Mixture`.
    x
        Shape ``(sample, feature)``.

    Returns
    -------
    FloatArray
        Shape ``(sample,)``, in nats.
    """
    n_components, n_features = means.shape
    centre = weights @ means
    factors = np.linalg.cholesky(covariances)
    whitening = np.linalg.inv(factors)  # (component, feature, feature), lower triangular
    columns = whitening.transpose(2, 0, 1).reshape(n_features, n_components * n_features)
    offsets = np.einsum("kij,kj->ki", whitening, means - centre).reshape(-1)
    log_scale = (
        np.log(weights)
        - np.log(np.diagonal(factors, axis1=1, axis2=2)).sum(axis=1)
        - 0.5 * n_features * math.log(2.0 * math.pi)
    )
    result = np.empty(x.shape[0])
    block = max(1, _BLOCK_VALUES // (n_components * n_features))
    for start in range(0, x.shape[0], block):
        rows = slice(start, start + block)
        white = (x[rows] - centre) @ columns - offsets
        squares = np.square(white).reshape(-1, n_components, n_features).sum(axis=2)
        logits = log_scale - 0.5 * squares
        top = logits.max(axis=1)
        result[rows] = top + np.log(np.exp(logits - top[:, None]).sum(axis=1))
    return result


def _problem(
    weights: FloatArray, means: FloatArray, covariances: FloatArray
) -> tuple[str, str] | None:
    if weights.ndim != 1 or means.ndim != 2 or weights.size == 0 or means.shape[1] == 0:
        return (
            f"weights {weights.shape} and means {means.shape} are not of shape (K,) and (K, m).",
            "Give one weight and one mean per component.",
        )
    n_components, n_features = means.shape
    wanted = (n_components, n_features, n_features)
    if weights.size != n_components or covariances.shape != wanted:
        return (
            f"{weights.size} weights do not fit {n_components} means or {covariances.shape}.",
            f"Give covariances of shape {wanted} and {n_components} weights.",
        )
    if not all(np.isfinite(part).all() for part in (weights, means, covariances)):
        return "a parameter is NaN or infinite.", "Give finite weights, means and covariances."
    if (weights <= 0).any() or abs(float(weights.sum()) - 1.0) > 1e-9:
        return (
            f"weights {weights.tolist()} are not positive with sum 1.",
            "Divide the weights by their sum, and drop components of zero weight.",
        )
    asymmetry = np.abs(covariances - covariances.transpose(0, 2, 1)).max()
    if asymmetry > 1e-9 * np.abs(covariances).max():
        return "a covariance is not symmetric.", "Give symmetric covariances."
    try:
        np.linalg.cholesky(covariances)
    except np.linalg.LinAlgError:
        return (
            "a covariance is not positive definite.",
            "Add a small variance to its diagonal.",
        )
    return None
