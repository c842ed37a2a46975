"""Units are read from names where people write them, and nowhere else."""

from __future__ import annotations

import pytest

from surmount.core.units import stem_and_unit


@pytest.mark.parametrize(
    ("name", "stem", "unit"),
    [
        ("height_cm", "height", "cm"),
        ("range_km", "range", "km"),
        ("sprawl_deg", "sprawl", "°"),
        ("force_N", "force", "N"),
        ("torque_Nm", "torque", "N·m"),
        ("payload_kg", "payload", "kg"),
        ("delay_ms", "delay", "ms"),
        ("rate_Hz", "rate", "Hz"),
        ("battery_V", "battery", "V"),
        ("current_A", "current", "A"),
        ("charge_percent", "charge", "%"),
        ("speed_mps", "speed", "m/s"),
        ("turn_degps", "turn", "°/s"),
        ("body_acceleration_mps2", "body_acceleration", "m/s²"),
        ("stiffness_Nmprad", "stiffness", "N·m/rad"),
        ("rate_deg_s", "rate", "°/s"),
        ("body_acceleration_m_s2", "body_acceleration", "m/s²"),
        ("time_s", "time", "s"),
    ],
)
def test_a_unit_is_what_follows_the_last_underscore(name, stem, unit):
    assert stem_and_unit(name) == (stem, unit)


@pytest.mark.parametrize("name", ["m", "_m", "steps", "map", "task_map", "speed_mpx", "x_0", "a_p"])
def test_other_endings_are_part_of_the_name(name):
    assert stem_and_unit(name) == (name, "")
