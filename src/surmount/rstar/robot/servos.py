"""What ties and drives RSTAR's joints: parallelograms and servos."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import math

import mujoco

from surmount.rstar.robot.config import RobotConfig


def add_parallelogram(spec: mujoco.MjSpec, side: str, config: RobotConfig) -> None:
    """Tie carrier and rear rod to the front rod: q_carrier = −q_fbem, q_rear = q_fbem."""
    for follower, ratio in ((f"{side}_carrier", -1.0), (f"{side}_rear_rod", 1.0)):
        spec.add_equality(
            name=follower,
            type=mujoco.mjtEq.mjEQ_JOINT,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            name1=follower,
            name2=f"{side}_fbem",
            data=[0.0, ratio, *([0.0] * 10)],
            solref=[config.constraint_time_s, 1.0],
            solimp=[0.99, 0.999, 0.001, 0.5, 2.0],
        )


STOP_MARGIN_DEG = 1.0
"""How far beyond the range of commands a joint's stops are where no parts meet; assumed."""


def add_stops(joint: mujoco.MjsJoint, stops_deg: tuple[float, float], config: RobotConfig) -> None:
    """Give a joint stops, which hold where an obstacle is stronger than the servo."""
    joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
    joint.range = [math.radians(stop) for stop in stops_deg]
    joint.solref_limit = [config.constraint_time_s, 1.0]


def add_servo(
    spec: mujoco.MjSpec,
    joint: str,
    *,
    gains: tuple[float, float],
    torque_nm: float,
    target: tuple[float, float],
    rate: float,
) -> None:
    """Add a servo whose control is the rate of its target.

    A position servo's damping is its motor's and acts at the joint whatever the torque limit, so
    that a joint set free far from its target turns at ``torque_nm / damping`` at most. A stiffness
    of zero makes a speed servo: its target is an angular speed.
    """
    stiffness, damping = gains
    gain = stiffness if stiffness > 0 else damping
    if stiffness > 0:
        spec.joint(joint).damping[0] = damping
    servo = spec.add_actuator(name=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT, target=joint)
    servo.dyntype = mujoco.mjtDyn.mjDYN_INTEGRATOR
    servo.gaintype = mujoco.mjtGain.mjGAIN_FIXED
    servo.gainprm[0] = gain
    servo.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    servo.biasprm[1] = -stiffness
    servo.biasprm[2] = 0.0 if stiffness > 0 else -damping
    servo.actlimited = True
    servo.actrange = target
    servo.ctrllimited = True
    servo.ctrlrange = (-rate, rate)
    servo.forcelimited = True
    servo.forcerange = (-torque_nm, torque_nm)
    servo.actearly = True
