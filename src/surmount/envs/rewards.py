"""The paper's reward (eq. 6), one small function for each of its terms, and their sum.

Every function works on arrays of shape ``(env,)`` and returns that shape; penalties are negative.
"""

from __future__ import annotations

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.envs.config import EnvConfig, RewardConfig
from surmount.envs.measures import Measures


def time_penalty(
    yaw_deg: FloatArray, pitch_deg: FloatArray, steps_per_episode: int, config: RewardConfig
) -> FloatArray:
    """Return −(1 + 2 K_b)/S_m, with K_b = 1 when |yaw| or |pitch| exceeds the tilt limit."""
    tilted = np.maximum(np.abs(yaw_deg), np.abs(pitch_deg)) > config.tilt_limit_deg
    upright = -1.0 / steps_per_episode
    return np.where(tilted, -(1.0 + config.tilt_factor) / steps_per_episode, upright)


def distance_penalty(
    distance_m: FloatArray, yaw_deg: FloatArray, config: RewardConfig
) -> FloatArray:
    """Return −K_yaw · D_z, with D_z ≥ 0 the distance left to the target line, in m."""
    low, high = config.yaw_limits_deg
    near, middle, far = config.yaw_gains
    yaw = np.abs(yaw_deg)
    gain = np.where(yaw <= low, -near, np.where(yaw <= high, -middle, -far))
    return gain * (distance_m / config.distance_unit_m)


def speed_penalty(speed_mps: FloatArray, config: RewardConfig) -> FloatArray:
    """Return −1e-8 · |S|, with S the tangential speed in m/s."""
    return -config.speed_weight * (np.abs(speed_mps) / config.speed_unit_mps)


def motion_penalty(
    sprawl_change_deg: FloatArray, fbem_change_deg: FloatArray, config: RewardConfig
) -> FloatArray:
    """Return −0.005 · (|Δsprawl| + |ΔFBEM|), changes since the previous decision in degrees."""
    sprawl = config.sprawl_weight * np.abs(sprawl_change_deg)
    fbem = config.fbem_weight * np.abs(fbem_change_deg)
    return -(sprawl + fbem) / config.angle_unit_deg


def final_reward(reached: BoolArray, failed: BoolArray, config: RewardConfig) -> FloatArray:
    """Return +5 where the target was reached, −5 where the robot fell off (or diverged)."""
    return np.where(reached, config.target, np.where(failed, config.fall, 0.0))


def running_reward(now: Measures, change_deg: FloatArray, config: EnvConfig) -> FloatArray:
    """Return all of eq. 6 but the final reward.

    Parameters
    ----------
    now
        What is measured after the decision.
    change_deg
        Absolute changes of FBEM and sprawl over the decision, shape ``(2, env)``.
    config
        Target, cap, weights and units.
    """
    left_m = np.maximum(config.course.target_m - now.x_m, 0.0)
    yaw_deg, reward = now.yaw_deg, config.reward
    total = time_penalty(yaw_deg, now.pitch_deg, config.steps_per_episode, reward)
    total += distance_penalty(left_m, yaw_deg, reward)
    total += speed_penalty(now.speed_mps, reward)
    fbem_change_deg, sprawl_change_deg = change_deg
    total += motion_penalty(sprawl_change_deg, fbem_change_deg, reward)
    return total
