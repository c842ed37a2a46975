"""Logged trials drawn from what their log holds, for logs that cannot be simulated again.

A log holds time, sprawl, FBEM and the distance to the target point. It does not hold height, tilt,
lateral offset or the turning of the wheels: here the robot keeps to the middle of the course,
each axle stands on what lies below it, and the wheels roll. Near a step, and in the last
centimetres before the target, this is a guess.
"""

from __future__ import annotations

import math

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.rstar.course.config import CourseConfig, EnvConfig
from surmount.rstar.course.measures import FEATURE_NAMES
from surmount.rstar.course.obstacles import Obstacle, surface_m
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.course.start_poses import Start, start_height_m
from surmount.rstar.film.motion import Motion
from surmount.rstar.robot import constants as c
from surmount.rstar.robot import kinematics
from surmount.rstar.robot.running_gear import rolling_radius_m, wheel_names
from surmount.trials.trials import Trials

ROUNDS = 8
"""Rounds in which position and height are found from each other."""
CAPTION = "drawn from its log, which holds neither height nor tilt"


def replay_log(
    obstacle: Obstacle, config: EnvConfig, size_mm: float, features: FloatArray, *, success: bool
) -> Motion:
    """Return the motion that a log tells of.

    Parameters
    ----------
    obstacle, config
        Family and configuration.
    size_mm
        Size of the obstacle in mm.
    features
        Rows of :data:`~surmount.rstar.course.measures.FEATURE_NAMES`, shape ``(step, 4)``.
    success
        Whether the trial reached the target: its last row then lies beyond the target line.

    Raises
    ------
    InputError
        If the size is not admissible, time does not increase, or an angle is out of range.
    """
    obstacle.check_sizes(np.array([size_mm]))
    time_s, sprawl_deg, fbem_deg, distance_m = features.T
    _check(time_s, sprawl_deg, fbem_deg)
    course = config.course
    surface = surface_m(obstacle, course, course.target_m, np.array(size_mm))
    target_z_m = float(surface) + start_height_m(config)
    ahead = np.ones_like(distance_m)
    if success:
        ahead[-1] = -1.0
    shift_m = kinematics.body_shift_mm(fbem_deg) * 1e-3
    # Where the robot is along the course says how high it stands, and its height with the distance
    # where it is: begun level with the target point, this settles within a few rounds.
    z_m, pitch = np.full_like(distance_m, target_z_m), np.zeros_like(distance_m)
    x_m = distance_m
    for _ in range(ROUNDS):
        left_m = np.sqrt(np.maximum(distance_m**2 - (z_m - target_z_m) ** 2, 0.0))
        x_m = course.target_m - ahead * left_m
        z_m, pitch = _standing(obstacle, config, size_mm, x_m, sprawl_deg, fbem_deg)

    simulation = Simulation(obstacle, config, 1, 1)
    coordinates: FloatArray = simulation.batch.bind("qpos")
    wheels = [int(simulation.model.joint(name).qposadr[0]) for name in wheel_names(config.robot)]
    turned = (x_m - shift_m) / rolling_radius_m(config.robot)
    qpos = np.empty((time_s.size, coordinates.shape[1]))
    for row in range(time_s.size):
        start = Start(
            x_m=float(x_m[row]),
            y_m=0.0,
            z_m=float(z_m[row]),
            yaw_deg=0.0,
            sprawl_deg=float(sprawl_deg[row]),
            fbem_deg=float(fbem_deg[row]),
        )
        simulation.place(0, size_mm, start)
        qpos[row] = coordinates[0]
        half = -float(pitch[row]) / 2
        qpos[row, 3:7] = math.cos(half), 0.0, math.sin(half), 0.0
        qpos[row, wheels] = turned[row]
    end = "reached the target" if success else "did not reach the target"
    return Motion(
        obstacle=obstacle,
        config=config,
        size_mm=size_mm,
        caption=CAPTION,
        outcome=f"{end}; logged for {time_s[-1]:.2f} s",
        success=success,
        time_s=time_s - time_s[0],
        qpos=qpos,
        features=features,
    )


def _standing(
    obstacle: Obstacle,
    config: EnvConfig,
    size_mm: float,
    x_m: FloatArray,
    sprawl_deg: FloatArray,
    fbem_deg: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return height of the base in m and pitch in rad, with each axle on what lies below it."""
    course, half_m = config.course, c.WHEELBASE_MM / 2 * 1e-3
    shift_m = kinematics.body_shift_mm(fbem_deg) * 1e-3
    stand_m = kinematics.standing_height_mm(sprawl_deg, fbem_deg, config.robot.gear) * 1e-3
    front_m = support_m(obstacle, course, size_mm, x_m - shift_m + half_m)
    rear_m = support_m(obstacle, course, size_mm, x_m - shift_m - half_m)
    pitch = np.arcsin((front_m - rear_m) / (2 * half_m))
    z_m = (front_m + rear_m) / 2 + shift_m * np.sin(pitch) + stand_m * np.cos(pitch)
    return z_m, pitch


def support_m(
    obstacle: Obstacle, course: CourseConfig, size_mm: float, axle_m: FloatArray
) -> FloatArray:
    """Return how high a wheel is lifted where its axle stands at ``axle_m``, in m.

    Before and behind a step a wheel rests on the floor or on the step's edge, whichever is higher.
    """
    if obstacle.name != "step":
        return np.zeros_like(axle_m)
    radius_m = c.WHEEL_RADIUS_MM * 1e-3
    beside_m = np.maximum(np.maximum(-axle_m, axle_m - course.obstacle_length_m), 0.0)
    above_edge = np.sqrt(np.maximum(radius_m**2 - beside_m**2, 0.0))
    lifted = size_mm * 1e-3 + above_edge - radius_m
    return np.where(beside_m < radius_m, np.maximum(lifted, 0.0), 0.0)


def logged_features(trials: Trials, trial: int) -> FloatArray:
    """Return the rows of one trial, shape ``(step, 4)``, in the order of ``FEATURE_NAMES``.

    Raises
    ------
    InputError
        If the trials were logged with other features.
    """
    rows = slice(int(trials.starts[trial]), int(trials.starts[trial + 1]))
    return np.stack([trials.column(name)[rows] for name in FEATURE_NAMES], axis=1)


def _check(time_s: FloatArray, sprawl_deg: FloatArray, fbem_deg: FloatArray) -> None:
    if (np.diff(time_s) <= 0).any():
        raise InputError("The trial's `time_s` does not increase.", remedy="Correct the log.")
    # Encoders may read a little beyond the servos' ranges.
    outside = (np.abs(sprawl_deg - 90.0) > 100.0) | (np.abs(fbem_deg) > 80.0)
    if outside.any():
        row = int(outside.argmax())
        raise InputError(
            f"Row {row + 1} of the trial has sprawl {sprawl_deg[row]:g}° and FBEM "
            f"{fbem_deg[row]:g}°, which RSTAR cannot take.",
            remedy="Give angles in degrees: sprawl from 0 to 180, FBEM from -72 to 72.",
        )
