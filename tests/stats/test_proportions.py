import json

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.special import ndtri
from stats_reference import assert_equal, parametrized

from surmount.core.errors import InputError
from surmount.stats.proportions import proportion_intervals, proportion_test


@parametrized("proportions")
def test_statistic_p_value_and_interval_equal_prop_test_of_r(case):
    found = proportion_test(case["successes"], case["totals"], confidence=case["confidence"])
    assert found.statistic == pytest.approx(case["statistic"], rel=1e-6, abs=1e-25)
    assert found.p_value == pytest.approx(case["p_value"], rel=1e-6, abs=0)  # down to 1e-178
    assert_equal(found.proportions, case["proportions"])
    assert_equal([found.difference_lower, found.difference_upper], [case["lower"], case["upper"]])
    assert found.reason is None


@parametrized("proportions")
def test_intervals_of_one_rate_equal_wilsons_of_r(case):
    found = proportion_intervals(case["successes"], case["totals"], confidence=case["confidence"])
    assert_equal(found.lower, case["wilson_lower"])
    assert_equal(found.upper, case["wilson_upper"])


@pytest.mark.parametrize(
    ("with_curriculum", "without", "total", "published"),
    [(239, 1, 240, 468.07), (779, 244, 780, 809.76), (540, 512, 540, 26.73)],
)
def test_published_statistics_follow_from_the_published_counts(
    with_curriculum, without, total, published
):
    found = proportion_test([with_curriculum, without], [total, total])
    # The paper prints two decimals; 468.075 exactly is printed as 468.07.
    assert found.statistic == pytest.approx(published, abs=0.0051)
    assert found.p_value is not None
    assert found.p_value < 1e-6


rates = st.tuples(st.integers(0, 400), st.integers(1, 400)).filter(lambda pair: pair[0] <= pair[1])


@given(rates, rates)
def test_statistic_is_yates_closed_form_for_four_cells(first, second):
    (a, n), (b, m) = first, second
    assume(0 < a + b < n + m)
    found = proportion_test([a, b], [n, m])
    # N (|ad − bc| − N/2)² over the product of the margins; never corrected beyond zero.
    total, won = n + m, a + b
    cross = max(abs(a * (m - b) - b * (n - a)) - total / 2, 0)
    expected = total * cross**2 / (n * m * won * (total - won))
    # Equal formulas evaluated in another order: a few roundings apart, relative to the counts.
    assert found.statistic == pytest.approx(expected, rel=1e-9, abs=1e-9)
    smallest = min(n, m) * min(won, total - won)
    assert found.small_expected_counts == (smallest < 5 * total)


@given(rates, rates)
def test_exchanging_the_arms_turns_the_sign_of_the_difference_only(first, second):
    one = proportion_test([first[0], second[0]], [first[1], second[1]])
    two = proportion_test([second[0], first[0]], [second[1], first[1]])
    assert one.difference == -two.difference
    if one.statistic is None:
        assert two.statistic is None
    else:
        assert one.statistic == pytest.approx(two.statistic, rel=1e-9, abs=1e-12)
        assert one.difference_lower == pytest.approx(-two.difference_upper, abs=1e-12)


@given(rates)
def test_wilson_limits_are_the_rates_that_the_score_test_just_keeps(pair):
    found = proportion_intervals([pair[0]], [pair[1]], confidence=0.9)
    (rate,), tried = found.proportions, pair[1]
    for limit, end in ((found.lower[0], 0.0), (found.upper[0], 1.0)):
        if rate == end:
            assert limit == end
        else:
            score = (rate - limit) ** 2 / (limit * (1 - limit) / tried)
            assert score == pytest.approx(ndtri(0.95) ** 2, rel=1e-9)
    assert found.lower[0] <= rate <= found.upper[0]


@pytest.mark.parametrize(("won", "word"), [([30, 40], "succeeded"), ([0, 0], "failed")])
def test_arms_that_all_end_alike_have_a_reason_and_no_statistic(won, word):
    found = proportion_test(won, [30, 40])
    assert (found.statistic, found.p_value) == (None, None)
    assert (found.difference, found.difference_lower, found.difference_upper) == (0, None, None)
    assert found.reason is not None
    assert word in found.reason
    json.dumps(found.to_record(), allow_nan=False)


@pytest.mark.parametrize(
    ("won", "tried", "says"),
    [
        ([3, 4], [5], "differ in length"),
        ([3, 4, 5], [5, 5, 5], "two arms, not 3"),
        ([6, 4], [5, 5], "more successes"),
        ([0, 4], [0, 5], "no trials"),
        ([-1, 4], [5, 5], "must hold counts"),
        ([1.5, 4], [5, 5], "must hold counts"),
        ([float("nan"), 4], [5, 5], "NaN"),
        (["3", "4"], [5, 5], "not real numbers"),
        ([], [], "empty"),
    ],
)
def test_bad_counts_are_named(won, tried, says):
    with pytest.raises(InputError, match=says):
        proportion_test(won, tried)


def test_confidence_must_be_a_fraction():
    with pytest.raises(InputError, match="not between 0 and 1"):
        proportion_test([1, 2], [3, 4], confidence=95)
