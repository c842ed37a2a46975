"""The unscented Hellinger distance: metric properties, closed forms, reference values."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.integrate import quad
from strategies import counts, dimensions, moved, random_mixture, seeds

from surmount import Mixture, hellinger, hellinger_matrix
from surmount.analysis.reference import check_distances, check_hellinger
from surmount.analysis.sigma_points import sigma_points
from surmount.core.errors import InputError


def pair(seed, k, d):
    rng = np.random.default_rng(seed)
    return random_mixture(rng, k, d), random_mixture(rng, k + 1, d), rng


def gaussian(mean, covariance):
    mean = np.atleast_1d(np.asarray(mean, dtype=float))
    return Mixture(
        weights=np.ones(1),
        means=mean[None],
        covariances=np.atleast_2d(np.asarray(covariance, dtype=float))[None],
    )


def closed_form(p, q):
    """Hellinger distance of two Gaussians (Pardo 2006)."""
    s, t = p.covariances[0], q.covariances[0]
    mid, step = 0.5 * (s + t), p.means[0] - q.means[0]
    volume = (np.linalg.det(s) * np.linalg.det(t)) ** 0.25 / np.sqrt(np.linalg.det(mid))
    return np.sqrt(1.0 - volume * np.exp(-step @ np.linalg.solve(mid, step) / 8.0))


def textbook_unscented(p, q):
    """Kristan et al. 2011 written out point by point, with the axes of the shipped code."""
    density = lambda m, x: np.exp(m.log_density(x))  # noqa: E731
    total = 0.0
    for own in (p, q):
        sigma = sigma_points(own)
        a, b = density(p, sigma.points), density(q, sigma.points)
        mean = 0.5 * (a + b)
        total += 0.5 * np.sum(sigma.weights * (np.sqrt(a) - np.sqrt(b)) ** 2 / mean)
    return np.sqrt(0.5 * total)


@given(seed=seeds, k=counts, d=dimensions)
@settings(max_examples=60)
def test_distance_is_a_symmetric_number_from_0_to_1_and_0_to_itself(seed, k, d):
    p, q, rng = pair(seed, k, d)
    other = random_mixture(rng, k, d)  # as many components as p
    for one, two in ((p, q), (p, other)):
        assert 0.0 < hellinger(one, two) <= 1.0
        assert hellinger(one, two) == hellinger(two, one)  # by construction: one order for both
    assert hellinger(p, p) == 0.0  # by construction
    matrix = hellinger_matrix([p, q, other])
    assert (matrix == matrix.T).all()  # by construction: both triangles are one sum
    assert matrix.min() >= 0.0
    assert matrix.max() <= 1.0


@given(seed=seeds, k=counts, d=dimensions)
@settings(max_examples=60)
def test_distance_is_the_published_sum_over_sigma_points(seed, k, d):
    p, q, _ = pair(seed, k, d)
    assert hellinger(p, q) == pytest.approx(textbook_unscented(p, q), abs=1e-7)


@given(seed=seeds, d=dimensions)
@settings(max_examples=60)
def test_distance_does_not_change_under_affine_maps_of_the_features(seed, d):
    p, q, rng = pair(seed, 3, d)
    matrix = rng.standard_normal((d, d)) + 2.0 * np.eye(d)
    matrix *= 10.0 ** rng.uniform(-2, 2)
    if np.linalg.cond(matrix) > 1e3:
        return
    shift = 10.0 * rng.standard_normal(d)
    there = hellinger(moved(p, matrix, shift), moved(q, matrix, shift))
    # Axes of the mixture are eigenvectors: rounding grows with the condition of the map.
    assert there == pytest.approx(hellinger(p, q), abs=1e-6)


@given(seed=seeds, k=counts, d=dimensions)
@settings(max_examples=30)
def test_distance_does_not_depend_on_the_order_of_components(seed, k, d):
    p, q, rng = pair(seed, k, d)
    order = rng.permutation(k)
    shuffled = Mixture(
        weights=p.weights[order], means=p.means[order], covariances=p.covariances[order]
    )
    assert hellinger(shuffled, q) == pytest.approx(hellinger(p, q), abs=1e-9)


@pytest.mark.parametrize("shift", [0.3, 1.0, 2.0, 4.0, 8.0])
@pytest.mark.parametrize("d", [1, 2, 4])
def test_unscented_distance_of_shifted_gaussians_is_near_the_closed_form(d, shift):
    p, q = gaussian(np.zeros(d), np.eye(d)), gaussian(shift * np.eye(d)[0], np.eye(d))
    # Few sigma points see a smooth integrand: published errors are of this size.
    assert hellinger(p, q) == pytest.approx(closed_form(p, q), abs=0.06)


@pytest.mark.parametrize("seed", range(4))
def test_reference_agrees_with_the_closed_form_of_gaussians(seed):
    rng = np.random.default_rng(seed)
    p, q = random_mixture(rng, 1, 3), random_mixture(rng, 1, 3)
    check = check_hellinger(p, q, tolerance=2e-4)
    assert check.reached
    assert check.reference == pytest.approx(closed_form(p, q), abs=6 * check.standard_error + 1e-4)


@pytest.mark.parametrize("seed", range(3))
def test_reference_agrees_with_quadrature_of_mixtures_in_one_dimension(seed):
    p, q, _ = pair(seed, 3, 1)
    density = lambda m, x: np.exp(m.log_density(np.array([[x]]))[0])  # noqa: E731
    overlap, _ = quad(lambda x: np.sqrt(density(p, x) * density(q, x)), -20, 20, limit=400)
    check = check_hellinger(p, q, tolerance=2e-4)
    truth = np.sqrt(1.0 - overlap)
    assert check.reference == pytest.approx(truth, abs=6 * check.standard_error + 1e-4)
    # Largest error over random mixtures of one dimension in docs/results: 0.033.
    assert check.error == pytest.approx(0.0, abs=0.05)


def test_reference_matrix_lies_near_the_unscented_one():
    mixtures = [random_mixture(np.random.default_rng(seed), 6, 4) for seed in range(4)]
    check = check_distances(mixtures, tolerance=1e-3)
    assert check.standard_error.max() < 0.01
    # Largest error measured for 4 features in docs/results: 0.034 with 4 components.
    np.testing.assert_allclose(hellinger_matrix(mixtures), check.reference, atol=0.05)


def test_matrix_needs_little_memory_beside_its_result():
    n, k, d = 300, 2, 2
    rng = np.random.default_rng(0)
    mixtures = [random_mixture(rng, k, d) for _ in range(n)]
    hellinger_matrix(mixtures[:2])
    tracemalloc.start()
    matrix = hellinger_matrix(mixtures)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # A tile of 1 MiB and copies of the components; a tenth for what an interpreter adds. Another
    # matrix of the result's size, 0.7 MB, would not fit.
    assert matrix.nbytes < peak < matrix.nbytes + 1.1 * (2**20 + 60 * d**2 * n * k)


def test_matrix_holds_the_distances_of_all_pairs_for_unequal_components():
    mixtures = [random_mixture(np.random.default_rng(k), k, 3) for k in (1, 4, 2, 7, 3)]
    matrix = hellinger_matrix(mixtures)
    for i, p in enumerate(mixtures):
        for j, q in enumerate(mixtures):
            # Products of other shapes round otherwise: squares by 1e-13, and the distances of
            # these mixtures, all above 0.1, by less than 1e-12.
            assert matrix[i, j] == pytest.approx(hellinger(p, q), abs=1e-9)
            assert i == j or matrix[i, j] > 0.1
    assert (np.diag(matrix) == 0.0).all()  # by construction


def test_needle_like_mixtures_far_apart_are_told_apart_without_overflow():
    needles = [gaussian([1e5 * i, 0.0], np.diag([1e-8, 1e-8])) for i in range(3)]
    assert hellinger_matrix(needles)[np.triu_indices(3, 1)] == pytest.approx(1.0, abs=1e-12)
    near = [gaussian([1e5 + 1e-4 * i, 0.0], np.diag([1e-8, 1e-8])) for i in (0, 1)]
    exact = [gaussian([float(i), 0.0], np.eye(2)) for i in (0, 1)]
    # Distances of needles that overlap, beside one that is far: 1e5 + 1e-4 rounds at 1e-11.
    beside = hellinger_matrix([*near, needles[0]])[0, 1]
    assert beside == pytest.approx(hellinger(*exact), abs=1e-4)


def test_sigma_points_carry_mean_and_covariance_of_the_mixture():
    mixture = random_mixture(np.random.default_rng(0), 4, 5)
    sigma = sigma_points(mixture)
    assert sigma.weights.sum() == pytest.approx(1.0, abs=1e-12)
    mean = mixture.weights @ mixture.means
    np.testing.assert_allclose(sigma.weights @ sigma.points, mean, atol=1e-10)
    centred, spread = sigma.points - mean, mixture.means - mean
    covariance = np.einsum("k,kij->ij", mixture.weights, mixture.covariances)
    covariance += (mixture.weights[:, None] * spread).T @ spread
    np.testing.assert_allclose(
        (sigma.weights[:, None] * centred).T @ centred, covariance, atol=1e-10
    )


def test_mixtures_over_different_features_are_refused():
    with pytest.raises(InputError, match="same features"):
        hellinger(gaussian([0.0], [[1.0]]), gaussian([0.0, 0.0], np.eye(2)))
