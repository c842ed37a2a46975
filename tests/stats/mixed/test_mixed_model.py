import json

import numpy as np
import pandas as pd
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stats_reference import assert_equal, cases, parametrized

from surmount.core.errors import InputError
from surmount.stats.mixed import mixed_model

NAMES = {"response": "y", "group": "group", "method": "method", "subject": "network"}
RULES = pytest.mark.parametrize("rule", ["kenward-roger", "satterthwaite"])


def fitted(table, **options):
    return mixed_model(table, **NAMES, **options)


def small_table(networks=("n1", "n2", "n3"), methods=("control", "curriculum"), repetitions=3):
    rng = np.random.default_rng(7)
    rows = [
        (network, method, group, 10.0 * index + 3.0 * (method == "control") + rng.normal())
        for index, network in enumerate(networks)
        for method in methods
        for group in ("easy", "hard")
        for _ in range(repetitions)
    ]
    columns = ("network", "method", "group", "y")
    return dict(zip(columns, map(list, zip(*rows, strict=True)), strict=True))


def without(table, **labels):
    """Drop the rows that carry all the labels given."""
    keep = [
        any(table[name][row] != label for name, label in labels.items())
        for row in range(len(table["y"]))
    ]
    return {
        name: [value for value, kept in zip(column, keep, strict=True) if kept]
        for name, column in table.items()
    }


@RULES
@parametrized("mixed")
def test_variances_means_and_contrasts_equal_lmer_with_emmeans_of_r(case, rule):
    found = fitted(case["table"], degrees_of_freedom=rule, confidence=case["confidence"])
    expected = case[rule.replace("-", "_")]
    assert_equal(
        [found.reml_criterion, found.subject_variance, found.residual_variance],
        [case["reml_criterion"], case["subject_variance"], case["residual_variance"]],
    )
    assert found.singular == case["singular"]
    assert (found.singular_note is not None) == case["singular"]
    names = {"std_error": "std_error", "degrees_of_freedom": "df", "estimate": "estimate"}
    names |= {"lower": "lower", "upper": "upper"}
    for mine, theirs in names.items():
        assert_equal([getattr(row, mine) for row in found.means], expected["means"][theirs])
    for mine, theirs in (names | {"t": "t", "p_value": "p_value"}).items():
        assert_equal([getattr(row, mine) for row in found.contrasts], expected["contrasts"][theirs])
    pairs = [f"{row.method} - {row.reference}" for row in found.contrasts]
    assert pairs == expected["contrasts"]["pair"]


@RULES
@parametrized("mixed")
def test_interaction_equals_pbkrtest_and_lmertest_of_r(case, rule):
    found = fitted(case["table"], degrees_of_freedom=rule).interaction
    if case["interaction"] is None:  # a single group
        assert found.statistic is None
        assert found.reason is not None
    else:
        expected = case["interaction"][rule.replace("-", "_")]
        fields = ["statistic", "numerator_df", "denominator_df", "p_value"]
        assert_equal([getattr(found, field) for field in fields], [expected[f] for f in fields])


def test_balanced_variances_are_the_mean_squares_of_an_analysis_of_variance():
    table = small_table()
    found = fitted(table)
    y = np.array(table["y"]).reshape(3, 4, 3)  # (network, cell, repetition), as it was drawn
    left = y - y.mean(axis=(0, 2), keepdims=True)
    between = 12 * (left.mean(axis=(1, 2)) ** 2).sum() / 2
    within = ((left - left.mean(axis=(1, 2), keepdims=True)) ** 2).sum() / (36 - 4 - 2)
    assert found.residual_variance == pytest.approx(within, rel=1e-9)
    assert found.subject_variance == pytest.approx((between - within) / 12, rel=1e-9)
    # Differences within networks do not see the variance between them.
    assert found.contrasts[0].std_error == pytest.approx(np.sqrt(2 * within / 9), rel=1e-9)
    assert found.contrasts[0].degrees_of_freedom == pytest.approx(30, rel=1e-9)


@RULES
@given(st.randoms(use_true_random=False))
@settings(max_examples=10)
def test_order_of_the_rows_does_not_matter(rule, random):
    table = cases("mixed")["unbalanced"]["table"]
    order = random.sample(range(len(table["y"])), len(table["y"]))
    shuffled = {name: [column[row] for row in order] for name, column in table.items()}
    one, two = (fitted(t, degrees_of_freedom=rule) for t in (table, shuffled))
    for a, b in zip(one.contrasts, two.contrasts, strict=True):
        # Sums in another order differ in their last digits; p adds those of the t-law.
        assert_equal([a.estimate, a.degrees_of_freedom, a.p_value],
                     [b.estimate, b.degrees_of_freedom, b.p_value], rtol=1e-8)  # fmt: skip


@given(st.floats(-1e4, 1e4), st.floats(1e-3, 1e3))
@settings(max_examples=30)
def test_other_units_of_the_response_change_the_estimates_alone(shift, scale):
    table = cases("mixed")["unbalanced"]["table"]
    other = dict(table, y=(np.array(table["y"]) * scale + shift).tolist())
    one, two = fitted(table), fitted(other)
    # The shift costs digits: up to 1e4 against differences of 1e-3 · 10.
    for a, b in zip(one.contrasts, two.contrasts, strict=True):
        assert a.estimate == pytest.approx(b.estimate / scale, rel=1e-5)
        assert a.std_error == pytest.approx(b.std_error / scale, rel=1e-5)
        assert a.degrees_of_freedom == pytest.approx(b.degrees_of_freedom, rel=1e-5)
    assert one.residual_variance == pytest.approx(two.residual_variance / scale**2, rel=1e-5)


def test_the_order_of_the_methods_decides_the_sign():
    table = small_table()
    one = fitted(table, methods=["curriculum", "control"], groups=["hard", "easy"])
    two = fitted(table)
    assert [row.group for row in one.contrasts] == ["hard", "easy"]
    assert (one.contrasts[0].method, one.contrasts[0].reference) == ("curriculum", "control")
    assert one.contrasts[0].estimate == pytest.approx(-two.contrasts[1].estimate, rel=1e-12)
    assert one.contrasts[0].p_value == pytest.approx(two.contrasts[1].p_value, rel=1e-9)


@pytest.mark.parametrize("frame", [pd.DataFrame, pl.DataFrame])
def test_data_frames_give_what_a_mapping_gives(frame):
    table = small_table()
    assert fitted(frame(table)).to_record() == fitted(table).to_record()


def test_numbers_as_labels_are_ordered_as_numbers():
    table = dict(small_table(), network=[2, 10, 9] * 12)
    assert fitted(table).subjects == ("2", "9", "10")


def test_an_empty_cell_leaves_the_other_groups_with_their_contrasts():
    table = without(small_table(), method="control", group="hard")
    found = fitted(table)
    easy, hard = found.contrasts
    assert easy.p_value is not None
    assert (hard.estimate, hard.p_value) == (None, None)
    assert hard.reason == "Group `hard` has no row of control."
    assert found.reason is None
    json.dumps(found.to_record(), allow_nan=False)


def test_a_group_without_any_row_is_reported_when_it_is_named():
    found = fitted(small_table(), groups=["easy", "hard", "harder"])
    assert found.contrasts[2].reason == "Group `harder` has no row of control nor of curriculum."
    assert [row.n_rows for row in found.means] == [9, 9, 9, 9, 0, 0]
    assert found.interaction.numerator_df == 1


def test_a_single_method_has_means_and_no_contrast():
    found = fitted(small_table(methods=("control",)))
    assert all(row.std_error is not None for row in found.means)
    assert found.contrasts == ()
    assert found.interaction.reason is not None
    assert "two methods" in found.interaction.reason


def undefined_tables():
    one_network = small_table(networks=("n1",))
    confounded = small_table(networks=("n1", "n2"))
    confounded["network"] = [
        f"{m}-{g}" for m, g in zip(confounded["method"], confounded["group"], strict=True)
    ]
    one_row_each = dict(small_table(), network=[f"n{row}" for row in range(36)])
    exact = small_table()
    exact["y"] = [{"n1": 0.1, "n2": 7.7, "n3": 1e6}[network] for network in exact["network"]]
    constant = dict(small_table(), y=[0.1] * 36)
    return {
        "fewer than two networks": one_network,
        "rows of one network alone": confounded,
        "too few rows": one_row_each,
        "does not vary within networks": exact,
        "there is no residual variance": constant,
    }


@RULES
@pytest.mark.parametrize("says", undefined_tables())
def test_variances_that_cannot_be_estimated_leave_differences_and_a_reason(says, rule):
    found = fitted(undefined_tables()[says], degrees_of_freedom=rule)
    assert found.reason is not None
    assert says in found.reason
    assert (found.subject_variance, found.residual_variance, found.singular) == (None, None, None)
    for row in found.contrasts:
        assert row.estimate is not None
        assert (row.std_error, row.degrees_of_freedom, row.p_value) == (None, None, None)
        assert row.reason == found.reason
    assert found.interaction.reason == found.reason
    json.dumps(found.to_record(), allow_nan=False)


rows = st.lists(
    st.tuples(
        st.one_of(st.integers(-3, 3).map(float), st.floats(-1e6, 1e6)),
        st.sampled_from(["easy", "hard", "harder"]),
        st.sampled_from(["control", "curriculum"]),
        st.sampled_from(["n1", "n2", "n3"]),
    ),
    min_size=1,
    max_size=30,
)


@RULES
@given(rows)
@settings(max_examples=200)
def test_whatever_the_rows_the_result_is_finite_or_has_a_reason(rule, rows):
    table = dict(zip(("y", "group", "method", "network"), zip(*rows, strict=True), strict=True))
    found = fitted(table, degrees_of_freedom=rule)
    json.dumps(found.to_record(), allow_nan=False)
    for row in found.contrasts:
        assert (row.p_value is None) == (row.reason is not None)
        if row.p_value is not None:
            assert 0 <= row.p_value <= 1
            assert row.std_error > 0
            assert row.degrees_of_freedom > 0
    assert (found.interaction.p_value is None) == (found.interaction.reason is not None)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"y": [float("nan")] + [1.0] * 35}, "NaN, infinite or missing in 1 of 36 rows"),
        ({"y": [1.0, 2.0]}, "differ in length"),
        ({"y": ["long"] * 36}, "not real numbers"),
        ({"network": [None] * 36}, "no label in 36 of 36"),
        ({"group": [pd.NA] + ["easy"] * 35}, "no label in 1 of 36"),
    ],
)
def test_bad_columns_are_named(change, says):
    with pytest.raises(InputError, match=says):
        fitted(small_table() | change)


def test_bad_options_are_named():
    table = small_table()
    with pytest.raises(InputError, match="no column `y_deg`"):
        mixed_model(table, **(NAMES | {"response": "y_deg"}))
    with pytest.raises(InputError, match="no rule `z`"):
        fitted(table, degrees_of_freedom="z")
    with pytest.raises(InputError, match="`hard`, which its order easy does not name"):
        fitted(table, groups=["easy"])
    with pytest.raises(InputError, match="names a label twice"):
        fitted(table, methods=["control", "control"])
