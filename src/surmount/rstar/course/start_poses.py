"""Start poses: the fixed one of roll-outs, and random ones for training."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import Obstacle, Poses, ground_m
from surmount.rstar.robot import constants as c
from surmount.rstar.robot import kinematics

CANDIDATES = 16
"""Starts drawn at once, of which the first that fits is taken."""


@dataclass(frozen=True, kw_only=True)
class Start:
    """A level pose on the ground: position of the base in m, angles in degrees."""

    x_m: float
    y_m: float
    z_m: float
    yaw_deg: float
    sprawl_deg: float
    fbem_deg: float


def start_height_m(config: EnvConfig) -> float:
    """Return the height of the base above the ground in the start pose, standing level, in m."""
    height = kinematics.standing_height_mm(c.START_SPRAWL_DEG, c.START_FBEM_DEG, config.robot.gear)
    return float(height) * 1e-3


def fixed_start(config: EnvConfig) -> Start:
    """Return the start of every roll-out: sprawl 48°, FBEM 0°, fixed distance (paper III-C)."""
    return Start(
        x_m=config.course.fixed_start_m,
        y_m=0.0,
        z_m=start_height_m(config),
        yaw_deg=0.0,
        sprawl_deg=c.START_SPRAWL_DEG,
        fbem_deg=c.START_FBEM_DEG,
    )


def random_start(
    obstacle: Obstacle, config: EnvConfig, size_mm: float, rng: np.random.Generator
) -> Start:
    """Draw a start at which the robot stands clear of the obstacle.

    Position and angles are uniform over the configured ranges, given that the robot fits.

    Parameters
    ----------
    obstacle, config
        Family and configuration.
    size_mm
        Size of this episode's obstacle in mm.
    rng
        Source of randomness.
    """
    start = config.start
    front = start.front_m if start.region == "workspace" else 0.0
    low = [-start.rear_m, -start.lateral_m, -start.yaw_deg, start.sprawl_min_deg]
    high = [front, start.lateral_m, start.yaw_deg, start.sprawl_max_deg]
    lower = np.array([*low, -start.fbem_max_deg])
    upper = np.array([*high, start.fbem_max_deg])
    while True:
        drawn = lower + rng.random((CANDIDATES, lower.size)) * (upper - lower)
        x, y, yaw, sprawl, fbem = drawn.T
        poses = Poses(x_m=x, y_m=y, yaw_deg=yaw, sprawl_deg=sprawl, fbem_deg=fbem)
        fits, ground = ground_m(obstacle, config.course, size_mm, poses, config.robot.gear)
        if start.region == "before":
            _, reach = kinematics.fore_aft_extent_mm(fbem)
            fits &= x + reach * 1e-3 < 0
        if fits.any():
            first = int(fits.argmax())
            height = kinematics.standing_height_mm(sprawl[first], fbem[first], config.robot.gear)
            return Start(
                x_m=float(x[first]),
                y_m=float(y[first]),
                z_m=float(ground[first] + height * 1e-3),
                yaw_deg=float(yaw[first]),
                sprawl_deg=float(sprawl[first]),
                fbem_deg=float(fbem[first]),
            )
