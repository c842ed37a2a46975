"""RSTAR's dimensions, masses and ranges: each with its value, unit and source.

No CAD or URDF of the robot is public. The figures were read from a public built simulation by the
robot's makers, from the paper's text, or derived from both; what neither gives is assumed.

Frames. The *base* frame sits midway between the sprawl axes; x points forward, y left, z up. At
zero FBEM it is above the middle of the wheelbase. A point of a leg has two coordinates in the
plane across the robot: ``d`` along the leg, away from its sprawl axis, and ``t`` along the
outward normal of the leg. With the legs straight down ``d`` points down and ``t`` outwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Source(StrEnum):
    """Where a figure comes from."""

    SIMULATION = "read from the makers' public simulation of step climbing (IEEE Access 2023)"
    PAPER = "printed in the paper"
    DERIVED = "derived from the simulation's and the paper's figures"
    ASSUMED = "assumed: neither the paper nor the simulation gives it"


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One figure of the robot.

    Attributes
    ----------
    value
        The number, in ``unit``.
    unit
        Unit of the value, ``"1"`` for a ratio.
    source
        Where the number comes from.
    meaning
        What the number is, in a sentence.
    """

    value: float
    unit: str
    source: Source
    meaning: str


def _quantity(value: float, unit: str, source: Source, meaning: str) -> Quantity:
    return Quantity(value=value, unit=unit, source=source, meaning=meaning)


_S, _P, _D, _A = Source.SIMULATION, Source.PAPER, Source.DERIVED, Source.ASSUMED

QUANTITIES: dict[str, Quantity] = {
    # Mechanism
    "sprawl_axis_lateral": _quantity(28.57, "mm", _S, "Sprawl axis from the mid-plane."),
    "pivot_offset": _quantity(13.84, "mm", _S, "Sprawl axis to rod pivot, along the leg."),
    "rod_length": _quantity(50.09, "mm", _S, "Rod of the parallelogram, pivot to pivot."),
    "axle_offset": _quantity(19.99, "mm", _S, "Outer rod pivot to wheel axle, along the leg."),
    "rod_spacing": _quantity(50.3, "mm", _S, "Front rod to rear rod, fore-aft."),
    "wheelbase": _quantity(145.6, "mm", _S, "Front axle to rear axle."),
    # Running gear
    "wheel_radius": _quantity(30.58, "mm", _D, "Outer radius of the round wheels."),
    "tyre_width": _quantity(8.0, "mm", _D, "Width of the round wheels."),
    "wheel_offset": _quantity(11.7, "mm", _D, "Wheel centre outward of the leg plane."),
    "wheg_radius": _quantity(27.0, "mm", _D, "Tip of a wheg's spoke from its axle."),
    "wheg_inner_face": _quantity(13.2, "mm", _D, "Whegs' far face inward of the leg plane."),
    "wheg_outer_face": _quantity(10.0, "mm", _D, "Whegs' near face inward of the leg plane."),
    "wheg_spokes": _quantity(3, "1", _S, "Spokes of a wheg."),
    "spoke_width": _quantity(6.0, "mm", _A, "Width of a spoke across its length."),
    # Carrier
    "bar_thickness": _quantity(9.3, "mm", _S, "Carrier bar, across the leg plane."),
    "bar_height": _quantity(26.2, "mm", _S, "Carrier bar, along the leg."),
    "bar_length": _quantity(150.0, "mm", _S, "Carrier bar, fore-aft; the robot's length."),
    "nub_outer_face": _quantity(28.8, "mm", _S, "Motor nub's end outward of the leg plane."),
    "nub_fore_aft": _quantity(-19.0, "mm", _S, "Motor nub's axis ahead of mid-wheelbase."),
    "nub_radius": _quantity(6.0, "mm", _D, "Motor nub's radius."),
    # Body
    "body_top": _quantity(10.5, "mm", _D, "Body's top above the sprawl axes."),
    "body_bottom": _quantity(13.3, "mm", _D, "Body's bottom below the sprawl axes."),
    "body_half_width": _quantity(26.0, "mm", _D, "Body's half width."),
    "body_fore_aft": _quantity(-26.0, "mm", _D, "Body's centre ahead of mid-wheelbase at f = 0."),
    "body_length": _quantity(
        98.0, "mm", _A, "Body, fore-aft: the longest that stays within the published length."
    ),
    # Ranges and limits
    "sprawl_min": _quantity(0.0, "deg", _P, "Legs straight down."),
    "sprawl_max": _quantity(180.0, "deg", _P, "Legs straight up."),
    "fbem_max": _quantity(72.0, "deg", _P, "Largest swing of the rods to either side."),
    "speed_max": _quantity(0.25, "m/s", _P, "Largest speed to either side."),
    "sprawl_rate": _quantity(80.0, "deg/s", _D, "0.08 deg a step of 1 ms."),
    "fbem_rate": _quantity(80.0, "deg/s", _D, "0.08 deg a step of 1 ms."),
    "acceleration": _quantity(1.0, "m/s^2", _D, "1 mm/s a step of 1 ms."),
    "start_sprawl": _quantity(48.0, "deg", _P, "Sprawl at the start of a roll-out."),
    "start_fbem": _quantity(0.0, "deg", _P, "FBEM angle at the start of a roll-out."),
    # Masses
    "body_mass": _quantity(0.76, "kg", _S, "Body."),
    "connector_mass": _quantity(0.22, "kg", _S, "Each of two: sprawl axis to rod pivots."),
    "rod_mass": _quantity(0.04, "kg", _S, "Each of four rods."),
    "carrier_mass": _quantity(0.55, "kg", _S, "Each of two carriers."),
    "wheel_mass": _quantity(0.004, "kg", _S, "Each of six wheels: front, middle, rear."),
}
"""Every figure by name."""


def _value(name: str) -> float:
    return QUANTITIES[name].value


SPRAWL_AXIS_LATERAL_MM = _value("sprawl_axis_lateral")
PIVOT_OFFSET_MM = _value("pivot_offset")
ROD_LENGTH_MM = _value("rod_length")
AXLE_OFFSET_MM = _value("axle_offset")
ROD_SPACING_MM = _value("rod_spacing")
WHEELBASE_MM = _value("wheelbase")
WHEEL_RADIUS_MM = _value("wheel_radius")
TYRE_WIDTH_MM = _value("tyre_width")
WHEEL_OFFSET_MM = _value("wheel_offset")
WHEG_RADIUS_MM = _value("wheg_radius")
WHEG_INNER_FACE_MM = _value("wheg_inner_face")
WHEG_OUTER_FACE_MM = _value("wheg_outer_face")
WHEG_SPOKES = int(_value("wheg_spokes"))
SPOKE_WIDTH_MM = _value("spoke_width")
BAR_THICKNESS_MM = _value("bar_thickness")
BAR_HEIGHT_MM = _value("bar_height")
BAR_LENGTH_MM = _value("bar_length")
NUB_OUTER_FACE_MM = _value("nub_outer_face")
NUB_FORE_AFT_MM = _value("nub_fore_aft")
NUB_RADIUS_MM = _value("nub_radius")
BODY_TOP_MM = _value("body_top")
BODY_BOTTOM_MM = _value("body_bottom")
BODY_HALF_WIDTH_MM = _value("body_half_width")
BODY_FORE_AFT_MM = _value("body_fore_aft")
BODY_LENGTH_MM = _value("body_length")
SPRAWL_MIN_DEG = _value("sprawl_min")
SPRAWL_MAX_DEG = _value("sprawl_max")
FBEM_MAX_DEG = _value("fbem_max")
SPEED_MAX_MPS = _value("speed_max")
SPRAWL_RATE_DEGPS = _value("sprawl_rate")
FBEM_RATE_DEGPS = _value("fbem_rate")
ACCELERATION_MPS2 = _value("acceleration")
START_SPRAWL_DEG = _value("start_sprawl")
START_FBEM_DEG = _value("start_fbem")
BODY_MASS_KG = _value("body_mass")
CONNECTOR_MASS_KG = _value("connector_mass")
ROD_MASS_KG = _value("rod_mass")
CARRIER_MASS_KG = _value("carrier_mass")
WHEEL_MASS_KG = _value("wheel_mass")

SIMULATION_MASS_KG = (
    BODY_MASS_KG + 2 * CONNECTOR_MASS_KG + 4 * ROD_MASS_KG + 2 * CARRIER_MASS_KG + 6 * WHEEL_MASS_KG
)
"""Sum of the simulation's masses; a model of another mass keeps the fractions."""
