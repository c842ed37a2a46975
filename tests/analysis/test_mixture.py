"""The mixture record against scikit-learn, SciPy and closed forms."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.stats import multivariate_normal
from sklearn.mixture import GaussianMixture

from surmount import fit_mixture
from surmount.analysis.mixture import Mixture
from surmount.core.errors import InputError


def two_components() -> Mixture:
    return Mixture(
        weights=np.array([0.3, 0.7]),
        means=np.array([[0.0, 1.0], [2.0, -1.0]]),
        covariances=np.array([[[1.0, 0.2], [0.2, 0.5]], [[2.0, -0.4], [-0.4, 1.0]]]),
    )


def test_log_density_equals_scipy_gaussians_added_up():
    mixture, x = two_components(), np.random.default_rng(0).normal(size=(300, 2)) * 3
    parts = [
        weight * multivariate_normal(mean, covariance).pdf(x)
        for weight, mean, covariance in zip(
            mixture.weights, mixture.means, mixture.covariances, strict=True
        )
    ]
    # Both sides round to a few units in the last place of numbers up to 40.
    np.testing.assert_allclose(mixture.log_density(x), np.log(np.sum(parts, axis=0)), atol=1e-12)


def test_log_density_stays_exact_far_from_the_origin():
    mixture = two_components()
    far = Mixture(
        weights=mixture.weights, means=mixture.means + 1e6, covariances=mixture.covariances
    )
    x = np.random.default_rng(0).normal(size=(50, 2))
    # x + 1e6 itself is rounded to 1e-10.
    np.testing.assert_allclose(far.log_density(x + 1e6), mixture.log_density(x), atol=1e-8)


def test_density_is_finite_where_all_components_underflow():
    assert np.isfinite(two_components().log_density(np.array([[1e8, -1e8]]))).all()


def test_bic_is_that_of_scikit_learn_for_the_same_parameters():
    x = np.random.default_rng(1).normal(size=(500, 3)) @ np.diag([1.0, 5.0, 0.1])
    mixture = fit_mixture(x, 3, seed=0)
    other = GaussianMixture(3)
    other.weights_, other.means_ = mixture.weights, mixture.means
    other.covariances_ = mixture.covariances
    other.precisions_cholesky_ = np.linalg.cholesky(np.linalg.inv(mixture.covariances))
    assert mixture.bic == pytest.approx(other.bic(x), rel=1e-9)


def test_samples_have_the_moments_of_the_mixture():
    mixture, n = two_components(), 200_000
    x = mixture.sample(np.random.default_rng(2), n)
    mean = mixture.weights @ mixture.means
    centred = mixture.means - mean
    covariance = (
        np.einsum("k,kij->ij", mixture.weights, mixture.covariances)
        + (mixture.weights[:, None] * centred).T @ centred
    )
    # Standard errors are below 0.006; five of them.
    np.testing.assert_allclose(x.mean(axis=0), mean, atol=0.03)
    np.testing.assert_allclose(np.cov(x.T), covariance, atol=0.05)


def test_record_survives_json_unchanged():
    mixture = fit_mixture(np.random.default_rng(3).normal(size=(100, 2)), 2, seed=0)
    record = json.loads(json.dumps(mixture.to_record()))
    assert Mixture.from_record(record).to_record() == mixture.to_record()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"weights": np.array([0.5, 0.6])}, "sum 1"),
        ({"weights": np.array([1.0, 0.0])}, "positive"),
        ({"means": np.array([[np.nan, 0.0], [0.0, 0.0]])}, "NaN"),
        ({"means": np.zeros((3, 2))}, "do not fit"),
        ({"covariances": np.zeros((2, 2, 2))}, "positive definite"),
        ({"covariances": np.array([[[1.0, 0.5], [0.0, 1.0]]] * 2)}, "symmetric"),
    ],
)
def test_impossible_parameters_are_refused(change, words):
    mixture = two_components()
    parts = {name: getattr(mixture, name) for name in ("weights", "means", "covariances")}
    with pytest.raises(InputError, match=words):
        Mixture(**(parts | change))


def test_a_mixture_that_was_not_fitted_has_no_bic():
    with pytest.raises(InputError, match="not fitted"):
        _ = two_components().bic
    assert not two_components().converged
