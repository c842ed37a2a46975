"""What the sources leave open about the robot: gear, friction, servos, mass, physics step."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import get_args

from surmount.core.errors import ConfigError
from surmount.rstar.robot.constants import SIMULATION_MASS_KG
from surmount.rstar.robot.kinematics import Gear


def require_range(
    field: str, value: float, low: float, high: float, *, open_low: bool = False
) -> None:
    """Raise :class:`ConfigError` unless ``value`` is finite and within the range.

    Parameters
    ----------
    field
        Name of the field, for the message.
    value
        Value given.
    low, high
        Admissible range, both ends included unless ``open_low``.
    open_low
        Whether ``low`` itself is not admissible.
    """
    below = value <= low if open_low else value < low
    if not math.isfinite(value) or below or value > high:
        bracket = "(" if open_low else "["
        raise ConfigError(
            f"`{field}` is {value!r}.",
            remedy=f"Give a value in {bracket}{low:g}, {high:g}].",
        )


def require_choice(field: str, value: str, choices: tuple[str, ...]) -> None:
    """Raise :class:`ConfigError` unless ``value`` is one of ``choices``."""
    if value not in choices:
        raise ConfigError(f"`{field}` is {value!r}.", remedy=f"Choose among {', '.join(choices)}.")


@dataclass(frozen=True, kw_only=True)
class RobotConfig:
    """Properties of the simulated robot that no source fixes.

    The servo gains let a robot of the default mass, standing in its start pose, sag by less than
    1°, and their torque limits exceed what standing and driving need at every sprawl.

    Damping must stay below about half a joint's inertia per physics step: MuJoCo's ``implicitfast``
    integrates it implicitly, but computes contact forces without it, so that beyond this tyres
    would push with forces that the wheels never feel (with 0.2 N m s/rad on 1e-4 kg m² and steps of
    5 ms the robot outran its own wheels by 40 mm/s).
    """

    gear: Gear = "wheels"
    """Running gear: "wheels", "whegs" or "both"; the robot takes either or both (paper II)."""
    friction: float = 0.7
    """Sliding friction of tyres and spokes against everything, coefficient; assumed: within the
    range at which every variant is feasible and the hardest not by far (ADR 20), chosen by what the
    initiation then leaves to learn (ADR 21)."""
    body_friction: float = 0.3
    """Sliding friction of body, bars and nubs against everything, coefficient; assumed."""
    mass_kg: float = SIMULATION_MASS_KG
    """Total mass in kg, the parts keeping the simulation's fractions; the simulation's sum."""
    physics_step_s: float = 0.0025
    """Physics time step in s: the longest at which outcomes have converged (ADR 20). The makers'
    simulation steps at 1 ms."""
    constraint_time_s: float = 0.01
    """Time constant of contacts, stops and parallelograms in s, critically damped (the first number
    of MuJoCo's ``solref``); assumed: the shortest that the default physics step resolves. A
    property of the robot, not of the integration: a shorter step leaves it as it is (ADR 20)."""
    sprawl_stiffness_nmprad: float = 100.0
    """Sprawl servo: torque per angle error in N m/rad, each side; assumed."""
    sprawl_damping_nmsprad: float = 2.0
    """Sprawl servo: torque per angular speed in N m s/rad, each side; assumed."""
    sprawl_torque_nm: float = 8.0
    """Sprawl servo: largest torque in N m, each side; assumed."""
    fbem_stiffness_nmprad: float = 40.0
    """FBEM servo: torque per angle error in N m/rad, each side; assumed."""
    fbem_damping_nmsprad: float = 1.0
    """FBEM servo: torque per angular speed in N m s/rad, each side; assumed."""
    fbem_torque_nm: float = 4.0
    """FBEM servo: largest torque in N m, each side; assumed."""
    wheel_damping_nmsprad: float = 0.06
    """Wheel servo: torque per error of angular speed in N m s/rad, each wheel; assumed."""
    wheel_torque_nm: float = 0.5
    """Wheel servo: largest torque in N m, each wheel; assumed."""
    sprawl_armature_kgm2: float = 0.02
    """Inertia of the sprawl's motor and gears, seen at the joint, in kg m², each side; assumed."""
    fbem_armature_kgm2: float = 0.015
    """Inertia of the FBEM's motor and gears, seen at the joint, in kg m², each side; assumed."""
    wheel_armature_kgm2: float = 0.001
    """Inertia of each wheel's motor and gears, seen at the axle, in kg m²; assumed: a small rotor
    (1e-7 kg m²) behind a ratio of 100."""

    def __post_init__(self) -> None:
        require_choice("gear", self.gear, get_args(Gear))
        require_range("friction", self.friction, 0.0, 5.0)
        require_range("body_friction", self.body_friction, 0.0, 5.0)
        require_range("mass_kg", self.mass_kg, 0.1, 20.0)
        require_range("physics_step_s", self.physics_step_s, 0.0001, 0.01)
        require_range("constraint_time_s", self.constraint_time_s, 0.0, 0.1)
        if self.constraint_time_s < 2 * self.physics_step_s:
            raise ConfigError(
                f"`constraint_time_s` is {self.constraint_time_s!r}, less than two physics "
                f"steps of {self.physics_step_s!r} s: no contact as stiff can be integrated.",
                remedy=f"Give at least {2 * self.physics_step_s:g}, or shorten the physics step.",
            )
        positive = (
            "sprawl_stiffness_nmprad",
            "sprawl_damping_nmsprad",
            "sprawl_torque_nm",
            "fbem_stiffness_nmprad",
            "fbem_damping_nmsprad",
            "fbem_torque_nm",
            "wheel_damping_nmsprad",
            "wheel_torque_nm",
            "sprawl_armature_kgm2",
            "fbem_armature_kgm2",
            "wheel_armature_kgm2",
        )
        for name in positive:
            require_range(name, getattr(self, name), 0.0, 1e4, open_low=True)
