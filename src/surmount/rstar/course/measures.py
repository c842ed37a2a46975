"""What is measured of every simulation, and the features that are logged of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray, IntArray

MEASURES = ("yaw_deg", "pitch_deg", "fbem_deg", "sprawl_deg", "speed_mps", "x_m", "y_m", "z_m")
"""Rows of :class:`Measures`."""
TARGETS = ("speed_target_mps", "fbem_target_deg", "sprawl_target_deg")
"""Further rows where the servos' targets are observed, in the order of the actions."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Measures:
    """Measured state of every simulation.

    Angles are *measured* joint angles (mean of both sides), as encoders report them, not the
    servos' targets: observations, logged features and the reward's Δ all use these.

    Attributes
    ----------
    rows
        One row per measure, in the order of :data:`MEASURES`, shape ``(measure, env)``; each row
        is also a property of its name, of shape ``(env,)``. Where the servos' targets are
        observed, the rows of :data:`TARGETS` follow.
    carrier_x_m
        Position along the course of the middle between both carriers, half-way between their
        axles, shape ``(env,)``; None where nothing asks for it.
    """

    rows: FloatArray
    carrier_x_m: FloatArray | None = None

    @property
    def yaw_deg(self) -> FloatArray:
        """Heading of the base's lateral axis, in (−180, 180], left positive; pitch-free."""
        return self.rows[0]

    @property
    def pitch_deg(self) -> FloatArray:
        """Tilt of the base about its lateral axis, in (−180, 180], nose up positive."""
        return self.rows[1]

    @property
    def attitude_deg(self) -> FloatArray:
        """Yaw and pitch, shape ``(2, env)``."""
        return self.rows[:2]

    @property
    def fbem_deg(self) -> FloatArray:
        """FBEM angle; positive: body forward."""
        return self.rows[2]

    @property
    def sprawl_deg(self) -> FloatArray:
        """Sprawl angle; 0 legs down, 90 flat."""
        return self.rows[3]

    @property
    def joints_deg(self) -> FloatArray:
        """FBEM and sprawl angle, shape ``(2, env)``."""
        return self.rows[2:4]

    @property
    def speed_mps(self) -> FloatArray:
        """Tangential speed: mean rim speed of the driven wheels."""
        return self.rows[4]

    @property
    def x_m(self) -> FloatArray:
        """Position of the base along the course from the obstacle's front face."""
        return self.rows[5]

    @property
    def y_m(self) -> FloatArray:
        """Position of the base to the left."""
        return self.rows[6]

    @property
    def z_m(self) -> FloatArray:
        """Height of the base above the floor."""
        return self.rows[7]

    @property
    def position_m(self) -> FloatArray:
        """Position of the base, shape ``(3, env)``."""
        return self.rows[5:8]


FEATURE_NAMES = ("time_s", "sprawl_deg", "fbem_deg", "distance_m")
"""Features logged at every step (paper II-A)."""


def features(
    measures: Measures,
    steps: IntArray,
    step_s: FloatArray | float,
    target_point_m: FloatArray,
) -> FloatArray:
    """Return the logged features, shape ``(env, feature)``.

    The distance is Euclidean, in three dimensions, from the base to the target point.

    Parameters
    ----------
    measures
        What is measured.
    steps
        Steps since each episode began, shape ``(env,)``.
    step_s
        Time between steps in s.
    target_point_m
        Each environment's target point in m, shape ``(3, env)``; see
        :class:`~surmount.envs.episodes.Episodes`.
    """
    rows = np.empty((len(FEATURE_NAMES), steps.size))
    np.multiply(steps, step_s, out=rows[0])
    rows[1:3] = measures.joints_deg[::-1]
    offset_m = measures.position_m - target_point_m
    offset_m *= offset_m
    np.add.reduce(offset_m, axis=0, out=rows[3])
    np.sqrt(rows[3], out=rows[3])
    return rows.T
