import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mixed_data import random_data

from surmount.stats.mixed.random_intercept import decompose, fit, profile_deviance, undefined


def dense_deviance(subject_variance, residual_variance, response, cell, subject):
    """Minus twice the restricted log-likelihood as it is written down, with full matrices."""
    x, z = np.eye(cell.max() + 1)[cell], np.eye(subject.max() + 1)[subject]
    v = residual_variance * np.eye(response.size) + subject_variance * z @ z.T
    inverse = np.linalg.inv(v)
    information = x.T @ inverse @ x
    means = np.linalg.solve(information, x.T @ inverse @ response)
    left = response - x @ means
    return (
        (response.size - x.shape[1]) * np.log(2 * np.pi)
        + np.linalg.slogdet(v)[1]
        + np.linalg.slogdet(information)[1]
        + left @ inverse @ left
    ), means


@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.3, 3.0]))
@settings(max_examples=50)
def test_no_pair_of_variances_has_a_higher_restricted_likelihood(seed, network_sd):
    data = random_data(seed, network_sd=network_sd)
    found = fit(decompose(*data))
    tau, s = found.subject_variance, found.residual_variance
    best, means = dense_deviance(tau, s, *data)
    assert found.criterion == pytest.approx(best, abs=1e-8)
    assert found.means == pytest.approx(means, abs=1e-8)
    for factor in (0.5, 0.99, 1.01, 2.0):
        assert dense_deviance(tau * factor, s, *data)[0] >= best - 1e-9
        assert dense_deviance(tau, s * factor, *data)[0] >= best
    for other in np.geomspace(1e-6, 1e6, 60):  # far away, too
        assert profile_deviance(other, found.data) >= best - 1e-8


@pytest.mark.parametrize("spread", [1e3, 1e6, 1e9])
def test_a_huge_variance_between_subjects_is_found_and_not_taken_for_none(spread):
    subject = np.repeat([0, 1, 2], 20)
    cell = np.tile([0, 1], 30)
    noise = np.random.default_rng(2).normal(size=60)
    found = fit(decompose(noise + spread * np.array([0.0, 1.0, -1.0])[subject], cell, subject))
    # Between subjects 0 and ±spread: a sample variance of spread².
    assert found.subject_variance == pytest.approx(spread**2, rel=1e-2)
    assert 0.5 < found.residual_variance < 2.0


def test_subjects_with_one_cell_each_are_recognised_as_confounded():
    found = decompose(np.arange(6.0), np.repeat([0, 1], 3), np.repeat([0, 1], 3))
    assert not found.eigenvalues.any()
    assert undefined(found) is not None
