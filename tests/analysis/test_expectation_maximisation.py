"""Expectation-maximisation against scikit-learn as a second implementation."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from sklearn.exceptions import ConvergenceWarning
from sklearn.mixture import GaussianMixture
from strategies import counts, dimensions, random_mixture, seeds

from surmount import fit_mixture
from surmount.analysis.expectation_maximisation import (
    Components,
    coefficients,
    expand,
    expectation,
    maximise_likelihood,
)
from surmount.analysis.initialisation import spread_centres, start_components
from surmount.analysis.mixture import log_density
from surmount.core.errors import InputError


def samples(seed=0, n=3000, d=3, k=5):
    rng = np.random.default_rng(seed)
    x = random_mixture(rng, k, d).sample(rng, n)
    return (x - x.mean(axis=0)) / x.std(axis=0)


def second_opinion(x, start, iterations):
    model = GaussianMixture(
        start.weights.size,
        weights_init=start.weights,
        means_init=start.means,
        precisions_init=np.linalg.inv(start.covariances),
        reg_covar=1e-6,
        max_iter=iterations,
        tol=0.0,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        return model.fit(x)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("iterations", [1, 3, 15])
def test_same_start_reaches_the_parameters_of_scikit_learn(seed, iterations):
    x = samples(seed)
    start = start_components(x, 5, 1e-6, np.random.default_rng(seed))
    fit = maximise_likelihood(
        expand(x), start, regularisation=1e-6, tolerance=1e-300, max_iterations=iterations
    )
    other = second_opinion(x, start, iterations)
    # The same arithmetic in another order: rounding grows by iterations, far below 1e-8.
    np.testing.assert_allclose(fit.components.means, other.means_, atol=1e-8)
    np.testing.assert_allclose(fit.components.covariances, other.covariances_, atol=1e-8)
    assert fit.log_likelihood / x.shape[0] == pytest.approx(other.score(x), abs=1e-9)


@given(seed=seeds, k=counts, d=dimensions)
@settings(max_examples=40)
def test_product_with_expanded_features_is_the_weighted_log_density(seed, k, d):
    rng = np.random.default_rng(seed)
    mixture, x = random_mixture(rng, k, d), rng.standard_normal((7, d))
    components = Components(
        weights=mixture.weights, means=mixture.means, covariances=mixture.covariances
    )
    logits = coefficients(components) @ expand(x).T
    direct = log_density(mixture.weights, mixture.means, mixture.covariances, x)
    np.testing.assert_allclose(np.logaddexp.reduce(logits, axis=0), direct, atol=1e-9)


@pytest.mark.parametrize("weighted", [False, True])
def test_sums_over_many_pieces_are_those_of_responsibilities_whatever_the_threads(
    monkeypatch, weighted
):
    x = samples(n=40_001, d=2, k=16)  # several pieces, and a last one that is not whole
    start = start_components(x[:2000], 16, 1e-4, np.random.default_rng(0))
    counts = np.random.default_rng(1).integers(0, 3, x.shape[0]) if weighted else None
    parts = np.stack(
        [
            log_density(np.ones(1), mean[None], covariance[None], x) + np.log(weight)
            for weight, mean, covariance in zip(
                start.weights, start.means, start.covariances, strict=True
            )
        ]
    )
    total = np.logaddexp.reduce(parts, axis=0)
    times = np.ones(x.shape[0]) if counts is None else counts
    found = []
    for threads in ("1", "2", "3"):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        found.append(expectation(expand(x), start, counts))
    assert found[0][0] == pytest.approx(times @ total, rel=1e-12)
    np.testing.assert_allclose(
        found[0][1], (np.exp(parts - total) * times) @ expand(x), rtol=1e-9, atol=1e-8
    )
    for likelihood, sums in found[1:]:
        assert likelihood == found[0][0]
        np.testing.assert_array_equal(sums, found[0][1])


def test_likelihood_never_falls_without_regularisation():
    x, phi = samples(), expand(samples())
    start = start_components(x, 6, 1e-12, np.random.default_rng(0))
    curve = [
        maximise_likelihood(
            phi, start, regularisation=1e-12, tolerance=1e-300, max_iterations=n
        ).log_likelihood
        for n in range(25)
    ]
    assert (np.diff(curve) > -1e-6).all()
    assert curve[-1] > curve[0] + 1.0


def test_counting_a_sample_twice_equals_giving_it_twice():
    x = samples(n=400)
    weights = np.random.default_rng(0).integers(0, 3, size=400).astype(float)
    start = start_components(x, 3, 1e-6, np.random.default_rng(1))
    options = {"regularisation": 1e-6, "tolerance": 1e-300, "max_iterations": 8}
    counted = maximise_likelihood(expand(x), start, sample_weights=weights, **options)
    given_twice = maximise_likelihood(
        expand(np.repeat(x, weights.astype(int), axis=0)), start, **options
    )
    np.testing.assert_allclose(counted.components.means, given_twice.components.means, atol=1e-10)
    assert counted.n_samples == given_twice.n_samples


def test_fit_is_not_below_scikit_learns_own_start():
    x = samples(7, n=4000, d=4, k=8)
    ours = fit_mixture(x, 8, seed=0).fit
    theirs = GaussianMixture(8, random_state=0, n_init=3, reg_covar=1e-4).fit(x).score(x)
    # Local optima differ; ours may be better by any amount and worse by a little.
    assert ours.log_likelihood / x.shape[0] > theirs - 0.02


def test_known_mixture_is_recovered_within_its_sampling_error():
    rng = np.random.default_rng(5)
    means = np.array([[0.0, 0.0], [6.0, 0.0], [0.0, 6.0]])
    x = means[rng.integers(3, size=9000)] + rng.standard_normal((9000, 2))
    fitted = fit_mixture(x, 3, seed=1)
    order = np.argsort(fitted.means @ np.array([1.0, 2.0]))
    # Standard error of a mean is 0.018; five of them.
    np.testing.assert_allclose(fitted.means[order], means, atol=0.1)
    np.testing.assert_allclose(fitted.weights, 1 / 3, atol=0.03)
    assert fitted.converged


def test_bic_finds_the_number_of_separated_components():
    rng = np.random.default_rng(6)
    means = 12.0 * rng.standard_normal((4, 2))
    x = means[rng.integers(4, size=2000)] + rng.standard_normal((2000, 2))
    assert fit_mixture(x, seed=0).n_components == 4


def test_fit_depends_neither_on_the_order_nor_on_the_units_of_the_samples():
    x = samples(8, n=800)
    scale, shift = np.array([1e-3, 1.0, 1e4]), np.array([5.0, -2.0, 1e5])
    plain = fit_mixture(x, 4, seed=3)
    other = fit_mixture(x[np.random.default_rng(0).permutation(800)] * scale + shift, 4, seed=3)
    np.testing.assert_allclose(other.means, plain.means * scale + shift, rtol=1e-5)
    moved = plain.fit.log_likelihood - 800 * np.log(scale).sum()
    assert other.fit.log_likelihood == pytest.approx(moved, abs=1e-3)


def test_fewer_distinct_samples_than_components_collapse_and_are_counted():
    x = np.repeat([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 20, axis=0)
    fitted = fit_mixture(x, 6, seed=0)
    assert fitted.n_components == 3
    assert fitted.fit.collapsed == 3
    assert fitted.fit.floored == 3
    assert np.isfinite(fitted.log_density(x)).all()


def test_starting_centres_are_distinct_samples():
    x = samples(n=50)
    centres = spread_centres(x, 10, np.random.default_rng(0))
    assert len({tuple(centre) for centre in centres}) == 10
    assert all((x == centre).all(axis=1).any() for centre in centres)


@pytest.mark.parametrize(
    ("x", "k", "words"),
    [
        (np.zeros(5), 2, "shape"),
        (np.array([[1.0, np.nan], [0.0, 1.0]]), 1, "NaN"),
        (np.column_stack([np.ones(9), np.arange(9.0)]), 2, "same value"),
        (np.arange(6.0).reshape(3, 2), 4, "4 components cannot be fitted to 3 samples"),
        (np.arange(6.0).reshape(3, 2), 0, "0 components"),
    ],
)
def test_samples_that_hold_no_mixture_are_refused(x, k, words):
    with pytest.raises(InputError, match=words):
        fit_mixture(x, k, seed=0)
