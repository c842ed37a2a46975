"""What is measured of every simulation, and the features that are logged of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray, IntArray

MEASURES = ("yaw_deg", "pitch_deg", "fbem_deg", "sprawl_deg", "speed_mps", "x_m", "y_m", "z_m")
"""Rows of :class:`Measures`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Measures:
    """Measured state of every simulation.

    Angles are *measured* joint angles (mean of both sides), as encoders report them, not the
    servos' targets: observations, logged features and the reward's Δ all use these.

    Attributes
    ----------
    rows
        One row per measure, in the order of :data:`MEASURES`, shape ``(measure, env)``; each row
        is also a property of its name, of shape ``(env,)``.
    """

    rows: FloatArray

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


FEATURE_NAMES = ("time_s", "sprawl_deg", "fbem_deg", "distance_m")
"""Features logged at every decision (paper II-A)."""


def features(
    measures: Measures,
    steps: IntArray,
    decision_interval_s: FloatArray | float,
    target_m: FloatArray | float,
) -> FloatArray:
    """Return the logged features, shape ``(env, feature)``.

    The distance is Euclidean, in the horizontal plane, from the base to the target point: the
    middle of the target line.

    Parameters
    ----------
    measures
        What is measured.
    steps
        Decisions since each episode began, shape ``(env,)``.
    decision_interval_s
        Time between decisions in s.
    target_m
        Position of the target line along the course in m.
    """
    rows = np.empty((len(FEATURE_NAMES), steps.size))
    np.multiply(steps, decision_interval_s, out=rows[0])
    rows[1:3] = measures.joints_deg[::-1]
    square = target_m - measures.x_m
    square *= square
    y_m = measures.y_m
    square += y_m * y_m
    np.sqrt(square, out=rows[3])
    return rows.T
