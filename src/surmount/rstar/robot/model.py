"""RSTAR as an MjSpec, built from the sourced constants and a configuration.

Tree of one side: base → leg (sprawl hinge) → front rod (FBEM hinge) → carrier (hinge) → wheels,
and leg → rear rod. Joint equalities turn the carrier back by the rod's angle and the rear rod
along with the front one, so the four bars stay a parallelogram and the carrier parallel to the
body.

Commands live in the simulation state: every servo integrates a *rate* (its control) into a target
(its activation), clamped to the paper's range, at every physics step. Holding a control for some
of them is therefore the paper's action re-applied at each, and both sides' targets, fed alike, stay
equal to the last bit.

The robot's parts cannot touch one another by construction (a test measures the distances over the
whole range), so its geoms collide with the world alone.
"""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import math

import mujoco

from surmount.rstar.robot import constants as c
from surmount.rstar.robot.config import RobotConfig
from surmount.rstar.robot.parts import SIDES, add_materials, solid, visual
from surmount.rstar.robot.running_gear import add_carrier, rolling_radius_m, wheel_names
from surmount.rstar.robot.servos import STOP_MARGIN_DEG, add_parallelogram, add_servo, add_stops

_MM = 1e-3
_BOX = mujoco.mjtGeom.mjGEOM_BOX
_CAPSULE = mujoco.mjtGeom.mjGEOM_CAPSULE


def add_robot(spec: mujoco.MjSpec, config: RobotConfig) -> None:
    """Add the robot, its servos and its materials to a model specification.

    Parameters
    ----------
    spec
        Model to extend. Angles are in radians; call before compiling.
    config
        What the sources leave open.
    """
    spec.compiler.degree = False
    option = spec.option
    option.timestep = config.physics_step_s
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    # A diverged state must be seen and reported, not replaced by the initial one.
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    # MuJoCo 4.0's several contacts of a cylinder and a box are on the wrong face in 1.7 % of
    # overlaps: tyres sank into edges by up to 30 mm without a force (ADR 22). One is right.
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_MULTICCD
    add_materials(spec)
    base = spec.worldbody.add_body(name="base", pos=[0, 0, 0.1])
    base.add_freejoint(name="base")
    scale = config.mass_kg / c.SIMULATION_MASS_KG
    _add_base(base, config, scale)
    for side, sign in SIDES.items():
        _add_leg(base, side, sign, config, scale)
        add_parallelogram(spec, side, config)
        _add_servos(spec, side, config)


def _add_base(base: mujoco.MjsBody, config: RobotConfig, scale: float) -> None:
    half_height = (c.BODY_TOP_MM + c.BODY_BOTTOM_MM) / 2
    solid(
        base,
        "body",
        _BOX,
        size=(c.BODY_LENGTH_MM / 2 * _MM, c.BODY_HALF_WIDTH_MM * _MM, half_height * _MM),
        pos=(c.BODY_FORE_AFT_MM * _MM, 0.0, (c.BODY_TOP_MM - half_height) * _MM),
        material="shell",
        friction=config.body_friction,
        mass=c.BODY_MASS_KG * scale,
    )
    for sign in SIDES.values():
        # The shafts that carry the legs.
        visual(
            base,
            _CAPSULE,
            size=(0.003, 0.033, 0.0),
            pos=(0.0, sign * c.SPRAWL_AXIS_LATERAL_MM * _MM, 0.0),
            material="metal",
            quat=(math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0),
        )


def _add_leg(
    base: mujoco.MjsBody,
    side: str,
    sign: float,
    config: RobotConfig,
    scale: float,
) -> None:
    """Add a leg. Leg frames keep the base's orientation at zero sprawl: z is −d, y is ± t."""
    leg = base.add_body(name=f"{side}_leg", pos=[0, sign * c.SPRAWL_AXIS_LATERAL_MM * _MM, 0])
    sprawl = leg.add_joint(
        name=f"{side}_sprawl", axis=[sign, 0, 0], armature=config.sprawl_armature_kgm2
    )
    # At the upper end both sides' nubs meet: they are the stop, and there is no room beyond.
    add_stops(sprawl, (c.SPRAWL_MIN_DEG - STOP_MARGIN_DEG, c.SPRAWL_MAX_DEG), config)
    half_spacing = c.ROD_SPACING_MM / 2
    visual(
        leg,
        _BOX,
        size=((half_spacing + 4) * _MM, 0.003, c.PIVOT_OFFSET_MM / 2 * _MM),
        pos=(0.0, 0.0, -c.PIVOT_OFFSET_MM / 2 * _MM),
        material="metal",
        mass=c.CONNECTOR_MASS_KG * scale,
    )
    for place, place_sign in (("front", 1.0), ("rear", -1.0)):
        rod = leg.add_body(
            name=f"{side}_{place}_rod",
            pos=[place_sign * half_spacing * _MM, 0, -c.PIVOT_OFFSET_MM * _MM],
        )
        joint = rod.add_joint(
            name=f"{side}_fbem" if place == "front" else f"{side}_rear_rod",
            axis=[0, 1, 0],
            armature=config.fbem_armature_kgm2 if place == "front" else 1e-5,
        )
        visual(
            rod,
            _CAPSULE,
            size=(0.0035, c.ROD_LENGTH_MM / 2 * _MM, 0.0),
            pos=(0.0, 0.0, -c.ROD_LENGTH_MM / 2 * _MM),
            material="metal",
            mass=c.ROD_MASS_KG * scale,
        )
        if place == "front":
            stop_deg = c.FBEM_MAX_DEG + STOP_MARGIN_DEG
            add_stops(joint, (-stop_deg, stop_deg), config)
            carrier = rod.add_body(name=f"{side}_carrier", pos=[0, 0, -c.ROD_LENGTH_MM * _MM])
            carrier.add_joint(name=f"{side}_carrier", axis=[0, 1, 0], armature=1e-5)
            add_carrier(carrier, side, sign, config, scale)


def _add_servos(spec: mujoco.MjSpec, side: str, config: RobotConfig) -> None:
    """Add a side's servos with the paper's ranges and limits of rate."""
    add_servo(
        spec,
        f"{side}_sprawl",
        gains=(config.sprawl_stiffness_nmprad, config.sprawl_damping_nmsprad),
        torque_nm=config.sprawl_torque_nm,
        target=(math.radians(c.SPRAWL_MIN_DEG), math.radians(c.SPRAWL_MAX_DEG)),
        rate=math.radians(c.SPRAWL_RATE_DEGPS),
    )
    add_servo(
        spec,
        f"{side}_fbem",
        gains=(config.fbem_stiffness_nmprad, config.fbem_damping_nmsprad),
        torque_nm=config.fbem_torque_nm,
        target=(-math.radians(c.FBEM_MAX_DEG), math.radians(c.FBEM_MAX_DEG)),
        rate=math.radians(c.FBEM_RATE_DEGPS),
    )
    radius_m = rolling_radius_m(config)
    for name in wheel_names(config):
        if name.startswith(side):
            add_servo(
                spec,
                name,
                gains=(0.0, config.wheel_damping_nmsprad),
                torque_nm=config.wheel_torque_nm,
                target=(-c.SPEED_MAX_MPS / radius_m, c.SPEED_MAX_MPS / radius_m),
                rate=c.ACCELERATION_MPS2 / radius_m,
            )
