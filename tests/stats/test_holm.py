"""Holm's adjustment equals R's and keeps its promise."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surmount.core.errors import InputError
from surmount.stats.holm import holm


def test_it_equals_r():
    # By R's function p.adjust with the method "holm".
    np.testing.assert_allclose(holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02])


@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_it_rejects_what_the_step_down_procedure_rejects(p_values):
    level, rejected = 0.05, set()
    for rank, index in enumerate(sorted(range(len(p_values)), key=lambda one: p_values[one])):
        if p_values[index] * (len(p_values) - rank) > level:
            break
        rejected.add(index)
    assert {int(one) for one in np.flatnonzero(holm(p_values) <= level)} == rejected


def test_what_is_no_p_value_is_refused():
    with pytest.raises(InputError, match="p values"):
        holm([0.1, float("nan")])
