"""What the robot measures, and how a policy sees it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import FloatArray
from surmount.envs.obstacles import Obstacle
from surmount.robot import constants as c

Observations = npt.NDArray[np.float32]


@dataclass(frozen=True, kw_only=True, eq=False)
class Measures:
    """Measured state of every simulation, each field of shape ``(env,)``.

    Angles are *measured* joint angles (mean of both sides), as encoders report them, not the
    servos' targets: observations, logged features and the reward's Δ all use these.

    Attributes
    ----------
    x_m, y_m, z_m
        Position of the base: along the course from the obstacle's front face, to the left, up.
    yaw_deg
        Heading of the base's lateral axis, in (−180, 180], left positive; unaffected by pitch.
    pitch_deg
        Tilt of the base about its lateral axis, in (−180, 180], nose up positive.
    sprawl_deg, fbem_deg
        Joint angles.
    speed_mps
        Tangential speed: mean rim speed of the driven wheels.
    """

    x_m: FloatArray
    y_m: FloatArray
    z_m: FloatArray
    yaw_deg: FloatArray
    pitch_deg: FloatArray
    sprawl_deg: FloatArray
    fbem_deg: FloatArray
    speed_mps: FloatArray


@dataclass(frozen=True, kw_only=True)
class ObservationTerm:
    """One entry of the observation: ``(value − centre) / scale``, clipped to ± ``bound``."""

    name: str
    unit: str
    centre: float
    scale: float
    bound: float


def observation_terms(obstacle: Obstacle) -> tuple[ObservationTerm, ...]:
    """Return the entries of the observation in order (paper III-B)."""
    yaw = ObservationTerm(name="yaw", unit="deg", centre=0.0, scale=90.0, bound=2.0)
    pitch = ObservationTerm(name="pitch", unit="deg", centre=0.0, scale=90.0, bound=2.0)
    middle, half = (obstacle.upper + obstacle.lower) / 2, (obstacle.upper - obstacle.lower) / 2
    return (
        yaw,
        *((pitch,) if obstacle.observes_pitch else ()),
        ObservationTerm(name="fbem", unit="deg", centre=0.0, scale=c.FBEM_MAX_DEG, bound=2.0),
        ObservationTerm(name="sprawl", unit="deg", centre=90.0, scale=90.0, bound=2.0),
        ObservationTerm(name="speed", unit="m/s", centre=0.0, scale=c.SPEED_MAX_MPS, bound=2.0),
        ObservationTerm(name="distance to obstacle", unit="m", centre=0.0, scale=0.3, bound=4.0),
        ObservationTerm(name="size", unit="mm", centre=middle, scale=half, bound=2.0),
    )


def observe(
    terms: tuple[ObservationTerm, ...], measures: Measures, size_mm: FloatArray
) -> Observations:
    """Return observations of shape ``(env, term)`` within the terms' bounds.

    The distance to the obstacle is signed: positive before its front face, negative beyond.
    """
    columns = {
        "yaw": measures.yaw_deg,
        "pitch": measures.pitch_deg,
        "fbem": measures.fbem_deg,
        "sprawl": measures.sprawl_deg,
        "speed": measures.speed_mps,
        "distance to obstacle": -measures.x_m,
        "size": size_mm,
    }
    observation = np.empty((size_mm.size, len(terms)), dtype=np.float32)
    for index, term in enumerate(terms):
        scaled = (columns[term.name] - term.centre) / term.scale
        observation[:, index] = np.minimum(np.maximum(scaled, -term.bound), term.bound)
    return observation


FEATURE_NAMES = ("time_s", "sprawl_deg", "fbem_deg", "distance_m")
"""Features logged at every decision (paper II-A)."""


def features(measures: Measures, time_s: FloatArray, target_m: float) -> FloatArray:
    """Return the logged features, shape ``(env, feature)``.

    The distance is Euclidean, in the horizontal plane, from the base to the target point: the
    middle of the target line.
    """
    row = np.empty((time_s.size, len(FEATURE_NAMES)))
    row[:, 0] = time_s
    row[:, 1] = measures.sprawl_deg
    row[:, 2] = measures.fbem_deg
    ahead = target_m - measures.x_m
    row[:, 3] = np.sqrt(ahead * ahead + measures.y_m * measures.y_m)
    return row
