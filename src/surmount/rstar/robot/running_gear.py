"""RSTAR's carriers and what they run on: round wheels, three-spoke whegs, or both."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import math

import mujoco
import numpy as np

from surmount.rstar.robot import constants as c
from surmount.rstar.robot.config import RobotConfig
from surmount.rstar.robot.parts import SIDES, solid, visual

_MM = 1e-3
_BOX = mujoco.mjtGeom.mjGEOM_BOX
_CYLINDER = mujoco.mjtGeom.mjGEOM_CYLINDER
_AXIS_ALONG_Y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)


def wheel_names(config: RobotConfig) -> tuple[str, ...]:
    """Return the names of the driven wheel joints; whegs add a middle one on each side."""
    places = ("front", "rear") if config.gear == "wheels" else ("front", "middle", "rear")
    return tuple(f"{side}_{place}" for side in SIDES for place in places)


def rolling_radius_m(config: RobotConfig) -> float:
    """Return the radius that turns wheel speed into tangential speed, in m."""
    return (c.WHEG_RADIUS_MM if config.gear == "whegs" else c.WHEEL_RADIUS_MM) * _MM


def add_carrier(
    carrier: mujoco.MjsBody, side: str, sign: float, config: RobotConfig, scale: float
) -> None:
    """Add bar, nub and wheels; the carrier's frame sits on the front rod's outer pivot."""
    middle, axle = -c.ROD_SPACING_MM / 2, -c.AXLE_OFFSET_MM
    wheels = wheel_names(config)
    # Wheels that are not fitted leave their mass on the carrier, so the fractions hold.
    missing = 3 - len(wheels) // 2
    solid(
        carrier,
        f"{side}_bar",
        _BOX,
        size=(c.BAR_LENGTH_MM / 2 * _MM, c.BAR_THICKNESS_MM / 2 * _MM, c.BAR_HEIGHT_MM / 2 * _MM),
        pos=(middle * _MM, 0.0, axle * _MM),
        material="carrier",
        friction=config.body_friction,
        mass=(c.CARRIER_MASS_KG + missing * c.WHEEL_MASS_KG) * scale,
    )
    nub_inner = c.BAR_THICKNESS_MM / 2
    solid(
        carrier,
        f"{side}_nub",
        _CYLINDER,
        size=(c.NUB_RADIUS_MM * _MM, (c.NUB_OUTER_FACE_MM - nub_inner) / 2 * _MM),
        pos=(
            (middle + c.NUB_FORE_AFT_MM) * _MM,
            sign * (c.NUB_OUTER_FACE_MM + nub_inner) / 2 * _MM,
            axle * _MM,
        ),
        material="metal",
        friction=config.body_friction,
        quat=_AXIS_ALONG_Y,
    )
    offsets = {"front": c.WHEELBASE_MM / 2, "middle": 0.0, "rear": -c.WHEELBASE_MM / 2}
    for name in wheels:
        if name.startswith(side):
            place = name.removeprefix(f"{side}_")
            wheel = carrier.add_body(
                name=name, pos=[(middle + offsets[place]) * _MM, 0, axle * _MM]
            )
            wheel.add_joint(name=name, axis=[0, 1, 0], armature=config.wheel_armature_kgm2)
            tyre = config.gear != "whegs" and place != "middle"
            wheg = config.gear != "wheels"
            mass = c.WHEEL_MASS_KG * scale / (int(tyre) + int(wheg))
            if tyre:
                _add_tyre(wheel, name, sign, config, mass)
            if wheg:
                _add_wheg(wheel, name, sign, config, mass)


def _add_tyre(
    wheel: mujoco.MjsBody, name: str, sign: float, config: RobotConfig, mass_kg: float
) -> None:
    offset = sign * c.WHEEL_OFFSET_MM * _MM
    half_width = c.TYRE_WIDTH_MM / 2 * _MM
    solid(
        wheel,
        f"{name}_tyre",
        _CYLINDER,
        size=(c.WHEEL_RADIUS_MM * _MM, half_width),
        pos=(0.0, offset, 0.0),
        material="tyre",
        friction=config.friction,
        mass=mass_kg,
        quat=_AXIS_ALONG_Y,
    )
    # A hub with a cross of holes makes the turning visible.
    visual(
        wheel,
        _CYLINDER,
        size=(0.6 * c.WHEEL_RADIUS_MM * _MM, half_width + 2e-4),
        pos=(0.0, offset, 0.0),
        material="hub",
        quat=_AXIS_ALONG_Y,
    )
    for turn in range(4):
        angle = turn * math.pi / 2
        reach = 0.36 * c.WHEEL_RADIUS_MM * _MM
        visual(
            wheel,
            _CYLINDER,
            size=(0.15 * c.WHEEL_RADIUS_MM * _MM, half_width + 4e-4),
            pos=(reach * math.sin(angle), offset, reach * math.cos(angle)),
            material="carrier",
            quat=_AXIS_ALONG_Y,
        )


def _add_wheg(
    wheel: mujoco.MjsBody, name: str, sign: float, config: RobotConfig, mass_kg: float
) -> None:
    half_width = c.SPOKE_WIDTH_MM / 2
    # The spoke's corners, not its middle, lie on the tip circle.
    length = math.sqrt(c.WHEG_RADIUS_MM**2 - half_width**2)
    half_thickness = (c.WHEG_INNER_FACE_MM - c.WHEG_OUTER_FACE_MM) / 2
    offset = -sign * (c.WHEG_INNER_FACE_MM + c.WHEG_OUTER_FACE_MM) / 2
    for spoke in range(c.WHEG_SPOKES):
        angle = 2 * math.pi * spoke / c.WHEG_SPOKES
        direction = np.array([math.sin(angle), 0.0, -math.cos(angle)])
        centre = direction * length / 2 + np.array([0.0, offset, 0.0])
        solid(
            wheel,
            f"{name}_spoke{spoke}",
            _BOX,
            size=(half_width * _MM, half_thickness * _MM, length / 2 * _MM),
            pos=(float(centre[0]) * _MM, float(centre[1]) * _MM, float(centre[2]) * _MM),
            material="wheg",
            friction=config.friction,
            mass=mass_kg / c.WHEG_SPOKES,
            quat=(math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0),
        )
