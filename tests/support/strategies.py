"""Random mixtures for the tests of this room."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from surmount.analysis.mixture import Mixture


def random_mixture(rng: np.random.Generator, n_components: int, d: int) -> Mixture:
    factors = 0.5 * rng.standard_normal((n_components, d, d))
    return Mixture(
        weights=rng.dirichlet(np.full(n_components, 3.0)),
        means=1.5 * rng.standard_normal((n_components, d)),
        covariances=factors @ factors.transpose(0, 2, 1) + 0.2 * np.eye(d),
    )


def moved(mixture: Mixture, matrix: np.ndarray, shift: np.ndarray) -> Mixture:
    """The mixture of the samples x ↦ A x + b."""
    return Mixture(
        weights=mixture.weights,
        means=mixture.means @ matrix.T + shift,
        covariances=matrix @ mixture.covariances @ matrix.T,
    )


seeds = st.integers(0, 2**32 - 1)
dimensions = st.integers(1, 6)
counts = st.integers(1, 6)
