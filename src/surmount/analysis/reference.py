"""Check of the unscented Hellinger distance: the same integral by randomised quasi-Monte Carlo.

The integrand (1 − √r)²/(1 + r), r = q/p, lies in [0, 1], so the estimate of D² has a bounded
variance whatever the mixtures. Its standard error comes from independently scrambled replicates.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from surmount.analysis.hellinger import hellinger, hellinger_matrix
from surmount.analysis.mixture import Mixture
from surmount.analysis.threads import spread
from surmount.core.arrays import FloatArray
from surmount.core.seeds import generator

_REPLICATES = 8
_FIRST_POWER = 9
_EDGE = 1e-12
"""Quasi-random numbers are kept this far from 0 and 1, where normal quantiles are infinite."""


@dataclass(frozen=True, kw_only=True)
class HellingerCheck:
    """The unscented distance beside a reference with an error bar.

    Attributes
    ----------
    unscented
        Distance by sigma points.
    reference
        Distance by quasi-Monte Carlo.
    standard_error
        Standard error of the reference distance.
    reached
        Whether the standard error came below the tolerance asked for.
    points
        Points at which both densities were evaluated.
    """

    unscented: float
    reference: float
    standard_error: float
    reached: bool
    points: int

    @property
    def error(self) -> float:
        """Unscented minus reference distance."""
        return self.unscented - self.reference


def check_hellinger(
    p: Mixture, q: Mixture, *, tolerance: float = 1e-3, max_points: int = 1 << 20, seed: int = 0
) -> HellingerCheck:
    """Compare the unscented distance of two mixtures with a reference that refines itself.

    Parameters
    ----------
    p, q
        Mixtures over the same features.
    tolerance
        Standard error of D² to reach; points are doubled until then.
    max_points
        Points after which the reference is given with the error that it has.
    seed
        Seed of the scrambling.
    """
    power, used = _FIRST_POWER, 0
    while True:
        values = np.asarray(
            [_estimate(p, q, power, generator(seed, power, i)) for i in range(_REPLICATES)]
        )
        used += 2 * _REPLICATES << power
        squared = float(values.mean())
        error = float(values.std(ddof=1)) / math.sqrt(_REPLICATES)
        if error <= tolerance or used + (4 * _REPLICATES << power) > max_points:
            break
        power += 1
    reference = math.sqrt(max(squared, 0.0))
    # d√y = dy / 2√y; near zero the distance is known to √error only.
    spread = error / (2.0 * reference) if squared > error else math.sqrt(error)
    return HellingerCheck(
        unscented=hellinger(p, q),
        reference=reference,
        standard_error=spread,
        reached=error <= tolerance,
        points=used,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class DistanceCheck:
    """Reference distances of all pairs of mixtures, to compare a matrix of unscented ones with.

    Attributes
    ----------
    reference
        Distances by quasi-Monte Carlo, shape ``(mixture, mixture)``.
    standard_error
        Standard error of each, shape ``(mixture, mixture)``; 0 on the diagonal.
    """

    reference: FloatArray
    standard_error: FloatArray


def check_distances(
    mixtures: Sequence[Mixture], *, tolerance: float = 1e-3, seed: int = 0
) -> DistanceCheck:
    """Return reference distances of all pairs of mixtures.

    Parameters
    ----------
    mixtures, tolerance, seed
        As in :func:`check_hellinger`.
    """
    n = len(mixtures)
    reference, error = np.zeros((n, n)), np.zeros((n, n))
    hellinger_matrix(mixtures)  # refuses mixtures over different features before the long part
    pairs = [(i, j) for i in range(n) for j in range(i)]
    found = spread(
        lambda pair: check_hellinger(
            mixtures[pair[0]], mixtures[pair[1]], tolerance=tolerance, seed=seed
        ),
        pairs,
    )
    for (i, j), one in zip(pairs, found, strict=True):
        reference[i, j] = reference[j, i] = one.reference
        error[i, j] = error[j, i] = one.standard_error
    return DistanceCheck(reference=reference, standard_error=error)


def _estimate(p: Mixture, q: Mixture, power: int, rng: np.random.Generator) -> float:
    """Return one estimate of D², half of its points from p and half from q."""
    return 0.5 * (_half(p, q, power, rng) + _half(q, p, power, rng))


def _half(own: Mixture, other: Mixture, power: int, rng: np.random.Generator) -> float:
    d = own.n_features
    uniform = qmc.Sobol(d + 1, rng=rng).random_base2(power)
    component = np.searchsorted(np.cumsum(own.weights), uniform[:, 0])
    component = np.minimum(component, own.n_components - 1)
    normal = ndtri(np.clip(uniform[:, 1:], _EDGE, 1.0 - _EDGE))
    factors = np.linalg.cholesky(own.covariances)[component]
    points = own.means[component] + np.einsum("nij,nj->ni", factors, normal)
    half_log_ratio = 0.5 * (other.log_density(points) - own.log_density(points))
    # (1 − √r)²/(1 + r) = 1 − sech(½ ln r)
    return float(np.mean(1.0 - 1.0 / np.cosh(np.clip(half_log_ratio, -350.0, 350.0))))
