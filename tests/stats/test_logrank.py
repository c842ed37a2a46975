import json

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.stats import CensoredData, logrank
from stats_reference import assert_equal, parametrized

from surmount.core.errors import InputError
from surmount.stats.logrank import log_rank

trials = st.lists(
    st.tuples(st.integers(0, 12), st.booleans(), st.sampled_from("ab")), min_size=2, max_size=40
).filter(lambda rows: len({row[2] for row in rows}) == 2)


@parametrized("survival")
def test_statistic_and_expected_counts_equal_survdiff_of_r(case):
    found = log_rank(case["time"], case["event"], case["group"])
    assert list(found.groups) == case["labels"]
    assert list(found.n_trials) == case["n"]
    assert list(found.observed) == case["observed"]
    assert_equal(found.expected, case["expected"])
    assert found.degrees_of_freedom == case["degrees_of_freedom"]
    assert_equal([found.statistic, found.p_value], [case["statistic"], case["p_value"]])


@given(trials)
def test_statistic_of_two_groups_is_the_square_of_scipys(rows):
    found = log_rank(*zip(*rows, strict=True))
    assume(found.statistic is not None)
    arms = [[row for row in rows if row[2] == label] for label in "ab"]
    first, second = (
        CensoredData.right_censored([row[0] for row in arm], [not row[1] for row in arm])
        for arm in arms
    )
    assert found.statistic == pytest.approx(logrank(first, second).statistic ** 2, abs=1e-9)


@given(trials)
def test_exchanging_the_groups_turns_the_sign_of_the_deviation_only(rows):
    one = log_rank(*zip(*rows, strict=True))
    two = log_rank(*zip(*[(t, e, {"a": "b", "b": "a"}[g]) for t, e, g in rows], strict=True))
    deviation = np.subtract(one.observed, one.expected)
    other = np.subtract(two.observed, two.expected)
    assert deviation == pytest.approx(other[::-1], abs=1e-9)
    assert deviation == pytest.approx(-other, abs=1e-9)
    assert deviation.sum() == pytest.approx(0, abs=1e-9)
    if one.statistic is None:
        assert two.statistic is None
    else:
        assert one.statistic == pytest.approx(two.statistic, abs=1e-9)


@given(trials, st.randoms(use_true_random=False))
def test_only_the_order_of_times_matters(rows, random):
    stretched = [(3.0 * t**2 + 1, e, g) for t, e, g in random.sample(rows, len(rows))]
    one, two = (log_rank(*zip(*order, strict=True)) for order in (rows, stretched))
    assert_equal([one.statistic, one.p_value], [two.statistic, two.p_value], rtol=1e-9)
    json.dumps(one.to_record(), allow_nan=False)


def test_without_a_finished_trial_there_is_a_reason_and_no_statistic():
    found = log_rank([20, 20, 20], [0, 0, 0], ["a", "a", "b"])
    assert (found.statistic, found.p_value, found.degrees_of_freedom) == (None, None, None)
    assert found.reason is not None
    assert "No trial finished" in found.reason


def test_groups_never_at_risk_together_have_a_reason_and_no_statistic():
    found = log_rank([1, 2, 3, 4], [0, 0, 1, 1], ["a", "a", "b", "b"])
    assert found.statistic is None
    assert found.reason is not None
    assert "never at risk together" in found.reason


def test_a_curriculum_that_is_faster_finishes_more_than_expected():
    rng = np.random.default_rng(1)
    time = np.concatenate([rng.exponential(3, 200), rng.exponential(6, 200)]).clip(max=20)
    found = log_rank(time, time < 20, ["curriculum"] * 200 + ["control"] * 200)
    by_label = dict(zip(found.groups, np.subtract(found.observed, found.expected), strict=True))
    assert by_label["curriculum"] > 0 > by_label["control"]
    assert found.p_value is not None
    assert found.p_value < 1e-4


@pytest.mark.parametrize(
    ("time", "event", "group", "says"),
    [
        ([1, 2], [1, 1], ["a", "a"], "only `a`"),
        ([1, 2], [1, 1], ["a"], "differ in length"),
        ([1, -2], [1, 1], ["a", "b"], "negative time"),
        ([1, 2], [1, 1], ["a", None], "no label"),
        ([1, 2], [1, 1], [1.0, float("nan")], "no label"),
    ],
)
def test_bad_trials_are_named(time, event, group, says):
    with pytest.raises(InputError, match=says):
        log_rank(time, event, group)
