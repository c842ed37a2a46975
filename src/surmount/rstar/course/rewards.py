"""The paper's reward (eq. 6), one small method for each of its terms, and their sum."""

from __future__ import annotations

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.measures import Measures

_NOTHING: FloatArray = np.array(0.0)


class Reward:
    """Eq. 6, with what follows from the configuration worked out once.

    Terms work on arrays of shape ``(env,)`` and return that shape; penalties are negative.

    Parameters
    ----------
    config
        Weights and units, cap and target.
    """

    def __init__(self, config: EnvConfig) -> None:
        self._reward = config.reward
        # Numbers that meet arrays are arrays: NumPy takes half as long again to make them so.
        self._target_m: FloatArray = np.array(config.course.target_m)
        self._tilt_limit_deg: FloatArray = np.array(config.reward.tilt_limit_deg)
        self._distance_unit_m: FloatArray = np.array(config.reward.distance_unit_m)
        self._speed_unit_mps: FloatArray = np.array(config.reward.speed_unit_mps)
        self._speed_weight: FloatArray = np.array(-config.reward.speed_weight)
        self._angle_unit_deg: FloatArray = np.array(-config.reward.angle_unit_deg)
        steps = config.steps_per_episode
        self._upright: FloatArray = np.array(-1.0 / steps)
        self._tilted = -(1.0 + config.reward.tilt_factor) / steps
        self._yaw_limits: FloatArray = np.array(config.reward.yaw_limits_deg)
        self._yaw_gains: FloatArray = -np.array(config.reward.yaw_gains)
        self._fbem_weight: FloatArray = np.array(config.reward.fbem_weight)
        self._sprawl_weight: FloatArray = np.array(config.reward.sprawl_weight)

    def time(self, tilt_deg: FloatArray) -> FloatArray:
        """Return −(1 + 2 K_b)/S_m, with K_b = 1 when |yaw| or |pitch| exceeds the tilt limit.

        ``tilt_deg`` holds |yaw| and |pitch|, shape ``(2, env)``. One number stands for all
        environments if none is tilted.
        """
        tilted = tilt_deg > self._tilt_limit_deg
        if not np.count_nonzero(tilted):
            return self._upright
        return np.where(tilted.any(axis=0), self._tilted, self._upright)

    def distance(self, left_m: FloatArray, yaw_deg: FloatArray) -> FloatArray:
        """Return −K_yaw · D_z, from D_z ≥ 0, the distance left to the target line, and |yaw|."""
        gain = self._yaw_gains.take(self._yaw_limits.searchsorted(yaw_deg))
        return gain * (left_m / self._distance_unit_m)

    def speed(self, speed_mps: FloatArray) -> FloatArray:
        """Return −1e-8 · |S|, from the absolute tangential speed."""
        return self._speed_weight * (speed_mps / self._speed_unit_mps)

    def motion(self, change_deg: FloatArray) -> FloatArray:
        """Return −0.005 · (|Δsprawl| + |ΔFBEM|).

        ``change_deg`` holds |ΔFBEM| and |Δsprawl| since the previous step, shape ``(2, env)``.
        """
        cost = self._sprawl_weight * change_deg[1]
        cost += self._fbem_weight * change_deg[0]
        cost /= self._angle_unit_deg
        return cost

    def final(self, reached: BoolArray, failed: BoolArray) -> FloatArray:
        """Return +5 where the target was reached, −5 where the robot fell off (or diverged)."""
        return np.where(reached, self._reward.target, np.where(failed, self._reward.fall, 0.0))

    def running(self, now: Measures, change_deg: FloatArray) -> FloatArray:
        """Return the sum of all terms but the final one.

        Parameters
        ----------
        now
            What is measured after the step. D_z is measured from the carriers where their
            position is among it, else from the base.
        change_deg
            Absolute changes of FBEM and sprawl over the step, shape ``(2, env)``.
        """
        point_m = now.x_m if now.carrier_x_m is None else now.carrier_x_m
        left_m = self._target_m - point_m
        np.maximum(left_m, _NOTHING, out=left_m)
        tilt_deg = np.abs(now.attitude_deg)
        total = self.distance(left_m, tilt_deg[0])
        total += self.time(tilt_deg)
        total += self.speed(np.abs(now.speed_mps))
        total += self.motion(change_deg)
        return total
