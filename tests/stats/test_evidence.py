import itertools
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import bootstrap as scipys_bootstrap
from stats_reference import parametrized

from surmount.core.errors import InputError
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.evidence import (
    bootstrap_interval,
    difference_interval,
    interquartile_mean,
    probability_of_improvement,
)
from surmount.stats.profile import performance_profile

ONCE = Bootstrap(seed=1)
SCORES = np.array([[0.2, 0.4, 0.9], [0.5, 0.5, 1.0], [0.1, 0.3, 0.7], [0.6, 0.2, 0.8]])


def mean(scores):
    return float(scores.mean())


@parametrized("evidence")
def test_interquartile_mean_and_wins_equal_trimmed_mean_and_wilcoxon_of_r(case):
    assert interquartile_mean(case["first"]) == pytest.approx(case["trimmed_first"], rel=1e-9)
    assert interquartile_mean(case["second"]) == pytest.approx(case["trimmed_second"], rel=1e-9)
    found = probability_of_improvement(case["first"], case["second"], ONCE, paired=False)
    assert found.estimate == pytest.approx(case["first_wins"], rel=1e-9)


def test_interval_is_that_of_all_possible_resamples_of_whole_networks():
    every = np.array([SCORES[list(rows)].mean() for rows in itertools.product(range(4), repeat=4)])
    found = bootstrap_interval(SCORES, Bootstrap(seed=1, resamples=20_000), statistic=mean)
    # 20,000 draws place a 2.5 % quantile within 0.1 % of probability, a step or two of the 256.
    assert np.mean(every < found.lower) <= 0.03
    assert np.mean(every <= found.lower) >= 0.02
    assert np.mean(every < found.upper) <= 0.98
    assert np.mean(every <= found.upper) >= 0.97
    assert found.estimate == pytest.approx(SCORES.mean(), rel=1e-12)


def test_interval_equals_scipys_bootstrap_over_networks():
    rows = np.random.default_rng(5).normal(size=(30, 4))
    found = bootstrap_interval(rows, Bootstrap(seed=2, resamples=5000), statistic=mean)
    expected = scipys_bootstrap(
        (rows.mean(axis=1),), np.mean, method="percentile", n_resamples=5000, rng=3
    ).confidence_interval
    # Each limit's Monte Carlo error is about 2 % of the interval's width at 5,000 resamples.
    width = expected.high - expected.low
    assert found.lower == pytest.approx(expected.low, abs=0.08 * width)
    assert found.upper == pytest.approx(expected.high, abs=0.08 * width)


def test_networks_are_redrawn_within_their_stratum_only():
    # Two strata without any difference between their networks: nothing is left to vary.
    strata = {"channel": np.full((3, 2), 0.2), "step": np.full((5, 4), 0.8)}
    found = bootstrap_interval(strata, ONCE, statistic=mean)
    assert found.estimate == pytest.approx((6 * 0.2 + 20 * 0.8) / 26, rel=1e-12)
    assert found.lower == pytest.approx(found.estimate, rel=1e-12)
    assert found.upper == pytest.approx(found.estimate, rel=1e-12)
    assert found.n_networks == (3, 5)


def test_pairs_from_one_initial_network_are_redrawn_together():
    shift = SCORES + 0.25
    paired = difference_interval(shift, SCORES, ONCE, statistic=mean, paired=True)
    apart = difference_interval(shift, SCORES, ONCE, statistic=mean, paired=False)
    assert (paired.lower, paired.upper) == (pytest.approx(0.25), pytest.approx(0.25))
    assert apart.lower < 0.2 < 0.25 < apart.upper


def test_same_seed_same_interval():
    rows = np.random.default_rng(6).normal(size=(9, 3))
    one, two, three = (bootstrap_interval(rows, Bootstrap(seed=seed)) for seed in (4, 4, 5))
    assert one == two
    assert (one.lower, one.upper) != (three.lower, three.upper)


scores = st.lists(st.floats(0, 1), min_size=2, max_size=8)


@given(scores, scores)
def test_probabilities_of_improvement_of_both_arms_add_up_to_one(first, second):
    quick = Bootstrap(seed=1, resamples=100)
    one = probability_of_improvement(first, second, quick, paired=False)
    two = probability_of_improvement(second, first, quick, paired=False)
    assert one.estimate + two.estimate == pytest.approx(1, abs=1e-12)
    assert 0 <= one.lower <= one.upper <= 1


def test_improvement_counts_each_variant_alike():
    first, second = np.array([[1.0, 0.0], [1.0, 0.0]]), np.array([[0.0, 0.0], [0.0, 1.0]])
    found = probability_of_improvement(first, second, ONCE, paired=True)
    # Variant 1 is won by all four pairs; variant 2 is tied in two and lost in two: ½(1 + ¼).
    assert found.estimate == pytest.approx(0.625, abs=1e-12)


def test_profile_is_the_share_of_scores_above_each_threshold():
    thresholds = [0.0, 0.5, 0.75, 1.0]
    found = performance_profile(SCORES, thresholds, ONCE)
    assert found.share == pytest.approx([1, 5 / 12, 3 / 12, 0], abs=1e-12)
    assert all(np.diff(found.share) <= 0)
    for low, share, high in zip(found.lower, found.share, found.upper, strict=True):
        assert low <= share <= high
    assert (found.lower[0], found.upper[-1]) == (1, 0)
    # At 0.5 the networks hold 1, 1, 1 and 2 of three: the share's resamples average 5/12.
    every = [(SCORES[list(r)] > 0.5).mean() for r in itertools.product(range(4), repeat=4)]
    assert found.upper[1] == pytest.approx(np.quantile(every, 0.975), abs=1 / 12)
    assert found.lower[1] == pytest.approx(np.quantile(every, 0.025), abs=1 / 12)


@pytest.mark.parametrize("one_network", [[[0.5, 0.7]], {"step": [0.5], "channel": [0.5, 0.6]}])
def test_fewer_than_two_networks_have_an_estimate_and_no_interval(one_network):
    arms = (one_network, one_network)
    for found in (
        bootstrap_interval(one_network, ONCE),
        difference_interval(*arms, ONCE, paired=True),
        probability_of_improvement(*arms, ONCE, paired=False),
        performance_profile(one_network, [0.6], ONCE),
    ):
        assert found.lower in (None, (None,))
        assert found.reason is not None
        assert "fewer than two networks" in found.reason
        json.dumps(found.to_record(), allow_nan=False)


@pytest.mark.parametrize(
    ("first", "second", "says"),
    [
        ([[0.1, 0.2]] * 2, [[0.1]] * 2, "2 and 1 variants"),
        ([0.1, 0.2], [0.1, 0.2, 0.3], "Pairs need as many networks"),
        ({"a": [0.1, 0.2]}, {"b": [0.1, 0.2]}, "different strata"),
        ({"a": [0.1, 0.2]}, [0.1, 0.2], "divided into strata"),
        ([0.1, float("nan")], [0.1, 0.2], "NaN"),
        ([[0.1, 0.2], [0.3]], [0.1, 0.2], "rows of different length"),
        ({}, {}, "no stratum"),
        (0.5, 0.5, "shape"),
    ],
)
def test_bad_scores_are_named(first, second, says):
    with pytest.raises(InputError, match=says):
        probability_of_improvement(first, second, ONCE, paired=True)


def test_too_few_resamples_are_refused():
    with pytest.raises(InputError, match="10 bootstrap resamples"):
        Bootstrap(seed=1, resamples=10)
