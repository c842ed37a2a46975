"""Closed forms of the mechanism: leg length, body shift, extents and standing height.

All functions are vectorised: angles may be scalars or arrays of any broadcastable shapes, and the
result has the broadcast shape. They are the oracle for the compiled model, and what places the
robot on the ground at a reset.

Sprawl ``s`` is 0° with the legs down, 90° flat outwards, 180° up. FBEM ``f`` is 0° with the rods
along the leg; positive ``f`` moves the body *forward* over the wheels.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import FloatArray
from surmount.rstar.robot import constants as c

Gear = Literal["wheels", "whegs", "both"]
"""Running gear: four round wheels, six three-spoke whegs, or both."""


def leg_length_mm(fbem_deg: npt.ArrayLike) -> FloatArray:
    """Return the distance from the sprawl axis to the wheel axles, along the leg, in mm."""
    return c.PIVOT_OFFSET_MM + c.ROD_LENGTH_MM * np.cos(np.deg2rad(fbem_deg)) + c.AXLE_OFFSET_MM


def body_shift_mm(fbem_deg: npt.ArrayLike) -> FloatArray:
    """Return how far the base is ahead of mid-wheelbase, in mm."""
    return c.ROD_LENGTH_MM * np.sin(np.deg2rad(fbem_deg))


def leg_point_mm(
    sprawl_deg: npt.ArrayLike, d_mm: npt.ArrayLike, t_mm: npt.ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Return where a point of a leg lies across the robot.

    Parameters
    ----------
    sprawl_deg
        Sprawl in degrees.
    d_mm, t_mm
        Coordinates along the leg and along its outward normal, in mm.

    Returns
    -------
    tuple
        Lateral distance from the mid-plane (outwards positive) and height above the sprawl axes,
        both in mm.
    """
    s = np.deg2rad(sprawl_deg)
    sine, cosine = np.sin(s), np.cos(s)
    d, t = np.asarray(d_mm, dtype=np.float64), np.asarray(t_mm, dtype=np.float64)
    return c.SPRAWL_AXIS_LATERAL_MM + d * sine + t * cosine, t * sine - d * cosine


def _corners(gear: Gear) -> FloatArray:
    """Return a leg's outermost points, rows of ``(d − leg length, t)``, shape ``(point, 2)``."""
    half_tyre = c.TYRE_WIDTH_MM / 2
    boxes = [
        (c.NUB_RADIUS_MM, c.BAR_THICKNESS_MM / 2, c.NUB_OUTER_FACE_MM),
        (c.BAR_HEIGHT_MM / 2, -c.BAR_THICKNESS_MM / 2, c.BAR_THICKNESS_MM / 2),
    ]
    if gear != "whegs":
        boxes.append(
            (c.WHEEL_RADIUS_MM, c.WHEEL_OFFSET_MM - half_tyre, c.WHEEL_OFFSET_MM + half_tyre)
        )
    if gear != "wheels":
        boxes.append((c.WHEG_RADIUS_MM, -c.WHEG_INNER_FACE_MM, -c.WHEG_OUTER_FACE_MM))
    return np.array(
        [(sign * d, t) for d, low, high in boxes for sign in (-1, 1) for t in (low, high)]
    )


def _leg_extent_mm(
    sprawl_deg: npt.ArrayLike, fbem_deg: npt.ArrayLike, gear: Gear
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return a leg's largest lateral distance, lowest and highest point in mm."""
    corners = _corners(gear)
    length = np.asarray(leg_length_mm(fbem_deg))[..., None]
    lateral, vertical = leg_point_mm(
        np.asarray(sprawl_deg, dtype=np.float64)[..., None], length + corners[:, 0], corners[:, 1]
    )
    return lateral.max(axis=-1), vertical.min(axis=-1), vertical.max(axis=-1)


def width_mm(sprawl_deg: npt.ArrayLike, fbem_deg: npt.ArrayLike, gear: Gear = "both") -> FloatArray:
    """Return the robot's width over wheels, whegs, nubs, bars and body, in mm."""
    lateral, _, _ = _leg_extent_mm(sprawl_deg, fbem_deg, gear)
    return 2 * np.maximum(lateral, c.BODY_HALF_WIDTH_MM)


def lowest_point_mm(
    sprawl_deg: npt.ArrayLike, fbem_deg: npt.ArrayLike, gear: Gear = "both"
) -> FloatArray:
    """Return the height of the robot's lowest point above the sprawl axes (negative), in mm."""
    _, low, _ = _leg_extent_mm(sprawl_deg, fbem_deg, gear)
    return np.minimum(low, -c.BODY_BOTTOM_MM)


def highest_point_mm(
    sprawl_deg: npt.ArrayLike, fbem_deg: npt.ArrayLike, gear: Gear = "both"
) -> FloatArray:
    """Return the height of the robot's highest point above the sprawl axes, in mm."""
    _, _, high = _leg_extent_mm(sprawl_deg, fbem_deg, gear)
    return np.maximum(high, c.BODY_TOP_MM)


def height_mm(
    sprawl_deg: npt.ArrayLike, fbem_deg: npt.ArrayLike, gear: Gear = "both"
) -> FloatArray:
    """Return the robot's height from its lowest to its highest point, in mm."""
    high = highest_point_mm(sprawl_deg, fbem_deg, gear)
    return high - lowest_point_mm(sprawl_deg, fbem_deg, gear)


def standing_height_mm(
    sprawl_deg: npt.ArrayLike, fbem_deg: npt.ArrayLike, gear: Gear = "both"
) -> FloatArray:
    """Return the height of the sprawl axes above the ground of a robot standing level, in mm."""
    return -lowest_point_mm(sprawl_deg, fbem_deg, gear)


def fore_aft_extent_mm(fbem_deg: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return how far the robot reaches behind (negative) and ahead of the base, in mm.

    Wheels, bars and body count, as seen from the base, which moves with the body.
    """
    carrier = -body_shift_mm(fbem_deg)
    reach = max(c.WHEELBASE_MM / 2 + c.WHEEL_RADIUS_MM, c.BAR_LENGTH_MM / 2)
    rear_body = c.BODY_FORE_AFT_MM - c.BODY_LENGTH_MM / 2
    front_body = c.BODY_FORE_AFT_MM + c.BODY_LENGTH_MM / 2
    return np.minimum(carrier - reach, rear_body), np.maximum(carrier + reach, front_body)
