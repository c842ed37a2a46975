"""Axes of a space of tasks: one scale for each kind, and the way there and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surmount.core.axis import CONTINUOUS, Axis, axis_of_values, common_axes, declared
from surmount.core.errors import InputError

LOG = Axis(kind="logarithmic")
WHOLE = Axis(kind="integer")
TERRAIN = Axis(kind="categorical", names=("flat", "stairs", "slope"))
RANGES = {CONTINUOUS: (-2.0, 3.0), LOG: (1e-3, 10.0), WHOLE: (-1.0, 4.0), TERRAIN: (0.0, 2.0)}


@pytest.mark.parametrize("axis", RANGES, ids=lambda axis: axis.kind)
def test_uniform_unit_coordinates_give_values_that_are_even_on_the_axis(axis):
    low, high = RANGES[axis]
    values = axis.at(np.random.default_rng(0).random(40_000), np.float64(low), np.float64(high))
    assert axis.holds(values).all()
    assert low <= values.min()
    assert values.max() <= high
    if axis.discrete:
        shares = np.unique(values, return_counts=True)[1] / values.size
        np.testing.assert_allclose(shares, 1 / (high - low + 1), atol=0.01)  # four deviations
    else:
        scaled = np.log(values / low) / np.log(high / low) if axis is LOG else None
        place = (values - low) / (high - low) if scaled is None else scaled
        np.testing.assert_allclose(
            np.quantile(place, [0.25, 0.5, 0.75]), [0.25, 0.5, 0.75], atol=0.02
        )


@pytest.mark.parametrize("axis", RANGES, ids=lambda axis: axis.kind)
@given(place=st.floats(0.0, 1.0))
def test_a_value_comes_back_from_its_unit_coordinate(axis, place):
    low, high = map(np.float64, RANGES[axis])
    value = axis.at(np.float64(place), low, high)
    np.testing.assert_allclose(
        axis.at(axis.place(value, low, high), low, high), value, rtol=1e-12, atol=1e-12
    )


def test_cells_are_halfway_on_the_scale():
    lower, upper = LOG.cells(np.array([0.01, 1.0, 100.0]))
    np.testing.assert_allclose(lower, [0.01, 0.1, 10.0])
    np.testing.assert_allclose(upper, [0.1, 10.0, 100.0])
    lower, upper = WHOLE.cells(np.array([1.0, 2.0, 4.0, 9.0]))
    assert lower.tolist() == [1, 2, 3, 7]
    assert upper.tolist() == [1, 2, 6, 9]
    lower, upper = TERRAIN.cells(np.array([0.0, 2.0]))
    assert lower.tolist() == upper.tolist() == [0, 2]


@given(values=st.lists(st.integers(-50, 50), min_size=2, max_size=12, unique=True))
def test_cells_of_whole_numbers_hold_each_number_once(values):
    values = np.sort(np.array(values, dtype=float))
    lower, upper = WHOLE.cells(values)
    held = [
        number
        for low, high in zip(lower, upper, strict=True)
        for number in np.arange(low, high + 1)
    ]
    assert held == list(range(int(values[0]), int(values[-1]) + 1))
    assert ((lower <= values) & (values <= upper)).all()


def test_an_environment_gets_a_float_an_int_or_a_name():
    assert [type(axis.value(2.0)) for axis in RANGES] == [float, float, int, str]
    assert TERRAIN.value(1.0) == "stairs"
    assert [WHOLE.text(3.0), TERRAIN.text(2.0), LOG.text(1e-3)] == ["3", "slope", "0.001"]


def test_values_given_by_hand_tell_their_kind():
    assert axis_of_values([1.0, 2]) == CONTINUOUS
    assert axis_of_values([1, np.int64(2)]) == WHOLE
    assert axis_of_values(["flat", "stairs", "flat", "slope"]) == TERRAIN
    assert axis_of_values([1, 2], "logarithmic") == LOG
    assert axis_of_values([3, 10], "categorical").names == ("3", "10")


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Axis(kind="ordinal"), "no kind of axis 'ordinal'"),
        (lambda: Axis(kind="categorical"), "is categorical and has the names"),
        (lambda: Axis(kind="categorical", names=("a", "a")), "has the names"),
        (lambda: Axis(names=("a",)), "is continuous and has the names"),
        (lambda: Axis(kind="categorical", names=("a\n",)), "cannot be printed"),
        (
            lambda: declared(CONTINUOUS, np.array([0.5]), "integer", "n"),
            "`n` is integer and cannot be 0.5",
        ),
        (lambda: declared(CONTINUOUS, np.array([0.0]), "logarithmic", "n"), "cannot be 0.0"),
        (
            lambda: common_axes([(WHOLE,), (LOG,)], ["n"]),
            "`n` is integer here and logarithmic there",
        ),
    ],
)
def test_what_does_not_fit_is_said(make, sentence):
    with pytest.raises(InputError, match=sentence):
        make()


def test_categories_of_several_tables_are_those_of_all():
    (axis,) = common_axes([(TERRAIN,), (Axis(kind="categorical", names=("mud", "flat")),)], ["t"])
    assert axis.names == ("flat", "stairs", "slope", "mud")
