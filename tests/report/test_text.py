"""Names and numbers as the page writes them."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.report.document.text import SPACE, axis_label, percent_interval, variant_range


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("sprawl_deg", "sprawl (°)"),
        ("time_s", "time (s)"),
        ("speed_m_s", "speed (m/s)"),
        ("yaw_rate_deg_s", "yaw rate (°/s)"),
        ("body_acceleration_m_s2", "body acceleration (m/s²)"),
        ("m_s", "m (s)"),
        ("height", "height"),
        ("s", "s"),
    ],
)
def test_units_at_the_end_of_names_are_printed_as_units(name, label):
    assert axis_label(name) == label


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ([55, 60, 65], "55–65"),
        ([60, 70, 75, 80, 95], "60, 70–80, 95"),
        ([55], "55"),
        ([55, 95], "55, 95"),
        ([55, 60, 80, 85, 105, 110, 130, 135, 155, 160], "55–160"),
    ],
)
def test_a_group_in_several_runs_is_not_written_as_one(values, text):
    variants = np.asarray(values, dtype=np.float64)[:, None]
    assert variant_range(("height_mm",), variants) == f"{text}{SPACE}mm"


@pytest.mark.parametrize(
    ("ends", "text"),
    [
        ((0.9960, 1.0), "99.6 to 100.0"),
        ((0.98, 1.0), "98 to 100"),
        ((1.0, 1.0), "100 to 100"),
        ((0.5, 0.5 + 1e-9), "50.000 to 50.000"),
    ],
)
def test_an_interval_is_written_with_the_digits_that_tell_its_ends_apart(ends, text):
    assert percent_interval(*ends) == f"{text}{SPACE}%"
