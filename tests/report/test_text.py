"""Names and numbers as the page writes them."""

from __future__ import annotations

import pytest

from surmount.report.text import axis_label


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
