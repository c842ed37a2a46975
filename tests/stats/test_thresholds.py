import json

import pytest

from surmount.core.errors import InputError
from surmount.stats.survival import kaplan_meier
from surmount.stats.thresholds import steps_to_threshold

STEPS = [100_000, 200_000, 300_000, 400_000]


def test_first_and_lasting_steps_are_evaluated_ones():
    found = steps_to_threshold(STEPS, [0.2, 0.96, 0.9, 0.95])
    assert found.first_steps == (200_000,)
    assert found.lasting_steps == (400_000,)
    assert found.n_reached == 1


def test_networks_that_never_get_there_count_as_needing_more():
    success = [[1, 1, 1, 1], [0, 1, 1, 1], [0, 0, 0, 0.94], [0, 0, 0, 0.5], [0, 0, 1, 0]]
    found = steps_to_threshold(STEPS, success)
    assert found.first_steps == (100_000, 200_000, None, None, 300_000)
    assert found.lasting_steps == (100_000, 200_000, None, None, None)
    expected = kaplan_meier([1e5, 2e5, 4e5, 4e5, 3e5], [1, 1, 0, 0, 1])
    assert found.median_steps == expected.median == 300_000
    assert found.median_lower == expected.median_lower
    assert found.reason is not None
    assert "3 of 5 networks reach 95% within 400,000 steps" in found.reason
    json.dumps(found.to_record(), allow_nan=False)


def test_where_too_few_get_there_the_median_has_a_reason():
    found = steps_to_threshold(STEPS, [[0, 0, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
    assert found.median_steps is None
    assert found.reason is not None


@pytest.mark.parametrize(
    ("steps", "success", "says"),
    [
        ([1, 2], [0.5], "2 evaluations"),
        ([2, 1], [0.5, 0.6], "ascend"),
        ([1, 2], [50, 60], "must be fractions"),
        ([1, 2], [0.5, float("nan")], "NaN"),
    ],
)
def test_bad_evaluations_are_named(steps, success, says):
    with pytest.raises(InputError, match=says):
        steps_to_threshold(steps, success)
