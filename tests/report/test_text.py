"""Names and numbers as the page writes them."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.report.text import SPACE, axis_label, variant_range


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
