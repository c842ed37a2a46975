import json

import numpy as np
import pytest
from scipy.stats import t as t_law

from surmount.core.errors import InputError
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.differences import network_difference
from surmount.stats.evidence import bootstrap_interval


def test_pairs_follow_the_t_law_of_their_differences():
    first, second = np.array([[0.9, 0.8], [0.7, 0.9], [1.0, 1.0]]), np.array([0.5, 0.4, 0.8])
    found = network_difference(first, np.stack([second, second], axis=1), paired=True)
    differences = np.array([0.35, 0.4, 0.2])
    error = differences.std(ddof=1) / np.sqrt(3)
    width = t_law.ppf(0.975, 2) * error
    assert found.estimate == pytest.approx(differences.mean(), rel=1e-12)
    assert found.t == pytest.approx(differences.mean() / error, rel=1e-9)
    assert found.degrees_of_freedom == 2
    assert found.p_value == pytest.approx(2 * t_law.sf(differences.mean() / error, 2), rel=1e-9)
    assert (found.lower, found.upper) == (
        pytest.approx(differences.mean() - width, rel=1e-9),
        pytest.approx(differences.mean() + width, rel=1e-9),
    )


def test_independent_arms_take_welchs_degrees_of_freedom():
    first, second = np.array([0.9, 0.7, 1.0, 0.8]), np.array([0.5, 0.1, 0.9])
    found = network_difference(first, second, paired=False)
    a, b = first.var(ddof=1) / 4, second.var(ddof=1) / 3
    assert found.degrees_of_freedom == pytest.approx((a + b) ** 2 / (a**2 / 3 + b**2 / 2), rel=1e-9)
    assert found.t == pytest.approx((first.mean() - second.mean()) / np.sqrt(a + b), rel=1e-9)
    assert found.n_networks == (4, 3)


@pytest.mark.parametrize(
    ("first", "second", "paired", "says"),
    [
        ([0.5], [0.4], True, "fewer than two networks"),
        ([0.1 + 0.2, 0.6], [0.2, 0.5], True, "differ by the same amount"),
        ([1.0, 1.0], [0.3, 0.3, 0.3], False, "no variance between networks"),
    ],
)
def test_without_variance_between_networks_there_is_a_reason(first, second, paired, says):
    found = network_difference(first, second, paired=paired)
    assert (found.lower, found.t, found.p_value) == (None, None, None)
    assert found.estimate == pytest.approx(np.mean(first) - np.mean(second), abs=1e-12)
    assert found.reason is not None
    assert says in found.reason
    json.dumps(found.to_record(), allow_nan=False)


def test_pairs_of_different_number_are_refused():
    with pytest.raises(InputError, match="as many networks"):
        network_difference([0.1, 0.2], [0.1, 0.2, 0.3], paired=True)


@pytest.mark.slow
def test_with_five_networks_the_t_interval_keeps_its_level_and_the_bootstrap_does_not():
    rng = np.random.default_rng(8)
    runs, by_t, by_bootstrap = 1000, 0, 0
    for run in range(runs):
        rows = rng.normal(size=5)
        exact = network_difference(rows, np.zeros(5), paired=True)
        drawn = bootstrap_interval(
            rows,
            Bootstrap(seed=run, resamples=400),
            statistic=lambda scores: float(scores.mean()),
        )
        by_t += exact.lower <= 0 <= exact.upper
        by_bootstrap += drawn.lower <= 0 <= drawn.upper
    # Binomial standard errors 0.7 and 1.2 %; the figure for the bootstrap is documented.
    assert by_t / runs == pytest.approx(0.95, abs=0.025)
    assert by_bootstrap / runs == pytest.approx(0.83, abs=0.045)
