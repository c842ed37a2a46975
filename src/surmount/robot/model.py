"""RSTAR as an MjSpec, built from the sourced constants and a configuration.

Tree of one side: base → leg (sprawl hinge) → front rod (FBEM hinge) → carrier (hinge) → wheels,
and leg → rear rod. Joint equalities turn the carrier back by the rod's angle and the rear rod
along with the front one, so the four bars stay a parallelogram and the carrier parallel to the
body.

Commands live in the simulation state: every servo integrates a *rate* (its control) into a target
(its activation), clamped to the paper's range, at every physics tick. Holding a control for some
ticks is therefore the paper's action re-applied at each of them, and both sides' targets, fed
alike, stay equal to the last bit.

Legs and body cannot touch by construction (a test measures the distance over the whole range), and
robot geoms do not collide with one another.
"""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import math

import mujoco
import numpy as np

from surmount.robot import constants as c
from surmount.robot.config import RobotConfig

SIDES = {"left": 1.0, "right": -1.0}
"""Sides of the robot and the sign of their lateral coordinate."""

ROBOT_BIT, WORLD_BIT = 1, 1
"""Robot geoms have contype 1 and conaffinity 0, everything else 0 and 1: they meet only others."""

_MM = 1e-3
_BOX = mujoco.mjtGeom.mjGEOM_BOX
_CYLINDER = mujoco.mjtGeom.mjGEOM_CYLINDER
_CAPSULE = mujoco.mjtGeom.mjGEOM_CAPSULE
_AXIS_ALONG_Y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)


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
    option.timestep = config.physics_tick_s
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    # A diverged state must be seen and reported, not replaced by the initial one.
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    _add_materials(spec)
    base = spec.worldbody.add_body(name="base", pos=[0, 0, 0.1])
    base.add_freejoint(name="base")
    scale = config.mass_kg / c.SIMULATION_MASS_KG
    _add_base(base, config, scale)
    for side, sign in SIDES.items():
        _add_side(spec, base, side, sign, config, scale)


def wheel_names(config: RobotConfig) -> tuple[str, ...]:
    """Return the names of the driven wheel joints; whegs add a middle one on each side."""
    places = ("front", "rear") if config.gear == "wheels" else ("front", "middle", "rear")
    return tuple(f"{side}_{place}" for side in SIDES for place in places)


def _add_materials(spec: mujoco.MjSpec) -> None:
    colours = {
        "shell": (0.93, 0.46, 0.13, 1.0),
        "metal": (0.62, 0.65, 0.70, 1.0),
        "carrier": (0.16, 0.20, 0.27, 1.0),
        "tyre": (0.09, 0.09, 0.10, 1.0),
        "hub": (0.80, 0.82, 0.85, 1.0),
        "wheg": (0.85, 0.16, 0.20, 1.0),
    }
    for name, colour in colours.items():
        spec.add_material(name=name, rgba=colour, specular=0.4, shininess=0.5, reflectance=0.0)


def _solid(
    body: mujoco.MjsBody,
    name: str,
    kind: mujoco.mjtGeom,
    *,
    size: tuple[float, ...],
    pos: tuple[float, float, float],
    material: str,
    friction: float,
    mass: float = 0.0,
    quat: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0),
) -> None:
    """Add a geom that touches the world; sizes and positions in m."""
    body.add_geom(
        name=name,
        type=kind,
        size=size,
        pos=pos,
        quat=quat,
        material=material,
        mass=mass,
        friction=[friction, 0.005, 0.0001],
        priority=1,
        condim=3,
        contype=ROBOT_BIT,
        conaffinity=0,
    )


def _visual(
    body: mujoco.MjsBody,
    kind: mujoco.mjtGeom,
    *,
    size: tuple[float, ...],
    pos: tuple[float, float, float],
    material: str,
    mass: float = 0.0,
    quat: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0),
) -> None:
    """Add a geom that touches nothing: for the eye, and to carry its mass."""
    body.add_geom(
        type=kind,
        size=size,
        pos=pos,
        quat=quat,
        material=material,
        mass=mass,
        contype=0,
        conaffinity=0,
        group=2,
    )


def _add_base(base: mujoco.MjsBody, config: RobotConfig, scale: float) -> None:
    half_height = (c.BODY_TOP_MM + c.BODY_BOTTOM_MM) / 2
    _solid(
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
        _visual(
            base,
            _CAPSULE,
            size=(0.003, 0.033, 0.0),
            pos=(0.0, sign * c.SPRAWL_AXIS_LATERAL_MM * _MM, 0.0),
            material="metal",
            quat=(math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0),
        )


def _add_side(
    spec: mujoco.MjSpec,
    base: mujoco.MjsBody,
    side: str,
    sign: float,
    config: RobotConfig,
    scale: float,
) -> None:
    """Add a leg. Leg frames keep the base's orientation at zero sprawl: z is −d, y is ± t."""
    leg = base.add_body(name=f"{side}_leg", pos=[0, sign * c.SPRAWL_AXIS_LATERAL_MM * _MM, 0])
    leg.add_joint(name=f"{side}_sprawl", axis=[sign, 0, 0], armature=config.sprawl_armature_kgm2)
    half_spacing = c.ROD_SPACING_MM / 2
    _visual(
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
        rod.add_joint(
            name=f"{side}_fbem" if place == "front" else f"{side}_rear_rod",
            axis=[0, 1, 0],
            armature=config.fbem_armature_kgm2 if place == "front" else 1e-5,
        )
        _visual(
            rod,
            _CAPSULE,
            size=(0.0035, c.ROD_LENGTH_MM / 2 * _MM, 0.0),
            pos=(0.0, 0.0, -c.ROD_LENGTH_MM / 2 * _MM),
            material="metal",
            mass=c.ROD_MASS_KG * scale,
        )
        if place == "front":
            carrier = rod.add_body(name=f"{side}_carrier", pos=[0, 0, -c.ROD_LENGTH_MM * _MM])
            carrier.add_joint(name=f"{side}_carrier", axis=[0, 1, 0], armature=1e-5)
            _add_carrier(carrier, side, sign, config, scale)
    _add_parallelogram(spec, side, config)
    _add_servo(
        spec,
        f"{side}_sprawl",
        gains=(config.sprawl_stiffness_nmprad, config.sprawl_damping_nmsprad),
        torque_nm=config.sprawl_torque_nm,
        target=(math.radians(c.SPRAWL_MIN_DEG), math.radians(c.SPRAWL_MAX_DEG)),
        rate=math.radians(c.SPRAWL_RATE_DEGPS),
    )
    _add_servo(
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
            _add_servo(
                spec,
                name,
                gains=(0.0, config.wheel_damping_nmsprad),
                torque_nm=config.wheel_torque_nm,
                target=(-c.SPEED_MAX_MPS / radius_m, c.SPEED_MAX_MPS / radius_m),
                rate=c.ACCELERATION_MPS2 / radius_m,
            )


def rolling_radius_m(config: RobotConfig) -> float:
    """Return the radius that turns wheel speed into tangential speed, in m."""
    return (c.WHEG_RADIUS_MM if config.gear == "whegs" else c.WHEEL_RADIUS_MM) * _MM


def _add_carrier(
    carrier: mujoco.MjsBody, side: str, sign: float, config: RobotConfig, scale: float
) -> None:
    """Add bar, nub and wheels; the carrier's frame sits on the front rod's outer pivot."""
    middle, axle = -c.ROD_SPACING_MM / 2, -c.AXLE_OFFSET_MM
    wheels = wheel_names(config)
    # Wheels that are not fitted leave their mass on the carrier, so the fractions hold.
    missing = 3 - len(wheels) // 2
    _solid(
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
    _solid(
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
    _solid(
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
    _visual(
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
        _visual(
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
        _solid(
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


def _add_parallelogram(spec: mujoco.MjSpec, side: str, config: RobotConfig) -> None:
    """Tie carrier and rear rod to the front rod: q_carrier = −q_fbem, q_rear = q_fbem."""
    for follower, ratio in ((f"{side}_carrier", -1.0), (f"{side}_rear_rod", 1.0)):
        spec.add_equality(
            name=follower,
            type=mujoco.mjtEq.mjEQ_JOINT,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            name1=follower,
            name2=f"{side}_fbem",
            data=[0.0, ratio, *([0.0] * 10)],
            # As stiff as the time step allows (twice the tick), critically damped.
            solref=[2 * config.physics_tick_s, 1.0],
            solimp=[0.99, 0.999, 0.001, 0.5, 2.0],
        )


def _add_servo(
    spec: mujoco.MjSpec,
    joint: str,
    *,
    gains: tuple[float, float],
    torque_nm: float,
    target: tuple[float, float],
    rate: float,
) -> None:
    """Add a servo whose control is the rate of its target.

    A stiffness of zero makes a speed servo: its target is an angular speed.
    """
    stiffness, damping = gains
    gain = stiffness if stiffness > 0 else damping
    servo = spec.add_actuator(name=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT, target=joint)
    servo.dyntype = mujoco.mjtDyn.mjDYN_INTEGRATOR
    servo.gaintype = mujoco.mjtGain.mjGAIN_FIXED
    servo.gainprm[0] = gain
    servo.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    servo.biasprm[1] = -stiffness
    servo.biasprm[2] = -damping
    servo.actlimited = True
    servo.actrange = target
    servo.ctrllimited = True
    servo.ctrlrange = (-rate, rate)
    servo.forcelimited = True
    servo.forcerange = (-torque_nm, torque_nm)
    servo.actearly = True
