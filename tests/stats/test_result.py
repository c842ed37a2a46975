from dataclasses import dataclass

import numpy as np
import pytest

from surmount.stats.result import Result


@dataclass(frozen=True, kw_only=True)
class Inner(Result):
    value: object


def test_nested_results_and_arrays_become_plain_json():
    nested = Inner(value=(Inner(value=np.float64(1.5)), np.array([1, 2]), None, "x", np.bool_(1)))
    assert nested.to_record() == {"value": [{"value": 1.5}, [1, 2], None, "x", True]}


@pytest.mark.parametrize("number", [float("nan"), float("inf"), np.array([1.0, np.nan])])
def test_a_number_that_is_not_finite_is_never_written(number):
    with pytest.raises(ValueError, match="not finite"):
        Inner(value=number).to_record()


def test_a_value_without_a_json_form_is_never_written():
    with pytest.raises(TypeError, match="set"):
        Inner(value={1}).to_record()
