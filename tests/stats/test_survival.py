import json
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stats_reference import assert_equal, parametrized

from surmount.core.errors import InputError
from surmount.stats.survival import kaplan_meier

CURVE_FIELDS = (
    *("time", "at_risk", "events", "censored"),
    *("survival", "log_std_error", "lower", "upper"),
)

trials = st.lists(st.tuples(st.integers(0, 20), st.booleans()), min_size=1, max_size=40)


@parametrized("survival")
def test_curve_interval_and_median_equal_survfit_of_r(case):
    time, event, group = (np.array(case[name]) for name in ("time", "event", "group"))
    for label, expected in case["curves"].items():
        mine = group == label
        found = kaplan_meier(time[mine], event[mine], confidence=case["confidence"])
        for field in [
            "time",
            "at_risk",
            "events",
            "censored",
            "survival",
            "log_std_error",
            "lower",
            "upper",
        ]:
            assert_equal(getattr(found, field), expected[field])
        for field in ("median", "median_lower", "median_upper"):
            assert_equal([getattr(found, field)], [expected[field]])


@given(trials)
def test_curve_is_the_product_of_the_shares_that_go_on(rows):
    found = kaplan_meier([row[0] for row in rows], [row[1] for row in rows])
    expected, curve = [], Fraction(1)
    for time in sorted({row[0] for row in rows}):
        left = sum(other >= time for other, _ in rows)
        curve *= 1 - Fraction(rows.count((time, True)), left)
        expected.append(float(curve))
    # At most 21 factors of doubles, each rounded once or twice.
    assert found.survival == pytest.approx(expected, rel=1e-14, abs=0)


@given(trials, st.randoms(use_true_random=False))
def test_order_of_the_trials_does_not_matter(rows, random):
    shuffled = random.sample(rows, len(rows))
    one, two = (kaplan_meier(*zip(*order, strict=True)) for order in (rows, shuffled))
    assert one.to_record() == two.to_record()


@given(trials)
def test_every_result_is_plain_json_and_accounts_for_every_trial(rows):
    found = kaplan_meier([row[0] for row in rows], [row[1] for row in rows])
    json.dumps(found.to_record(), allow_nan=False)
    assert found.events.sum() + found.censored.sum() == len(rows) == found.at_risk[0]
    undefined = None in (found.median, found.median_lower, found.median_upper, *found.lower)
    assert (found.reason is not None) == undefined


@given(st.lists(st.integers(1, 200), min_size=1, max_size=40))
def test_steps_of_a_control_interval_count_as_ties_however_they_were_added_up(steps):
    summed = [float(np.sum(np.full(count, 0.1))) for count in steps]
    cumulated = [float(np.full(count, 0.1).cumsum()[-1]) for count in steps]
    exact = kaplan_meier(np.array(steps) / 10, np.ones(len(steps)))
    for rounded in (summed, cumulated):
        found = kaplan_meier(rounded, np.ones(len(steps)))
        assert found.at_risk.tolist() == exact.at_risk.tolist()
        assert found.time == pytest.approx(exact.time, rel=1e-12)


def test_number_at_risk_and_curve_can_be_read_between_the_times():
    found = kaplan_meier([1, 2, 2, 4], [1, 1, 0, 0])
    times = np.array([0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0])
    assert found.at_risk_at(times).tolist() == [4, 4, 3, 3, 1, 1, 0]
    assert found.survival_at(times).tolist() == [1, 0.75, 0.75, 0.5, 0.5, 0.5, 0.5]


def test_trials_that_all_failed_have_a_flat_curve_and_a_reason():
    found = kaplan_meier([20, 20, 20], [False, False, False])
    assert (found.survival.tolist(), found.median) == ([1.0], None)
    assert found.reason is not None
    assert "No trial finished" in found.reason


@pytest.mark.parametrize(
    ("time", "event", "says"),
    [
        ([1, 2], [1], "differ in length"),
        ([1, -2], [1, 1], "negative time -2"),
        ([1, float("nan")], [1, 1], "first in row 1"),
        ([1, None], [1, 1], "first in row 1"),
        ([1, float("inf")], [1, 1], "infinite"),
        ([1, 2], [1, 2], "neither true nor false"),
        ([], [], "empty"),
        ([[1, 2]], [1, 2], "shape"),
        ([[1], [1, 2]], [1, 2], "cannot be read"),
        (["soon", "late"], [1, 1], "not real numbers"),
    ],
)
def test_bad_trials_are_named(time, event, says):
    with pytest.raises(InputError, match=says):
        kaplan_meier(time, event)
