"""Stable-Baselines3's running normalisation at a fraction of its cost per step.

The statistics, their names and the clipping are those of ``VecNormalize``; the numbers agree to
rounding. Only the way to them is shorter: no copies, and moments by plain sums.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecEnv, VecNormalize


class RunningMoments(RunningMeanStd):
    """Mean and variance of all rows seen so far, in double precision."""

    def update(self, arr: np.ndarray) -> None:
        """Take in rows, shape ``(row, …)`` (Chan et al., as Stable-Baselines3 does)."""
        rows = arr.shape[0]
        mean = np.add.reduce(arr, axis=0, dtype=np.float64) / rows
        spread = arr - mean
        spread *= spread
        delta = mean - self.mean
        count = self.count + rows
        # Share of the new rows; count · share is the weight of the shift between the two means.
        share = rows / count
        squares = self.var * self.count + np.add.reduce(spread, axis=0)
        squares += delta * delta * (self.count * share)
        self.mean = self.mean + delta * share
        self.var = squares / count
        self.count = count


class Normaliser(VecNormalize):
    """Standardises observations and scales rewards by running statistics.

    Parameters
    ----------
    env
        Environments with ``Box`` observations.
    observations, rewards
        Whether to standardise observations and to scale rewards.
    discount
        γ of the returns whose deviation scales the rewards.
    """

    def __init__(self, env: VecEnv, *, observations: bool, rewards: bool, discount: float) -> None:
        super().__init__(env, norm_obs=observations, norm_reward=rewards, gamma=discount)
        self.ret_rms = RunningMoments(shape=())
        if observations:
            self.obs_rms = RunningMoments(shape=self.observation_space.shape or ())

    def normalize_obs(self, obs: Any) -> Any:
        """Return standardised observations; the statistics stay as they are."""
        statistics = self.obs_rms if self.norm_obs else None
        if not isinstance(statistics, RunningMeanStd):
            return super().normalize_obs(obs)
        scaled = (obs - statistics.mean) / np.sqrt(statistics.var + self.epsilon)
        return _clipped(scaled, self.clip_obs).astype(np.float32)

    def normalize_reward(self, reward: np.ndarray) -> np.ndarray:
        """Return scaled rewards; the statistics stay as they are."""
        if not self.norm_reward:
            return super().normalize_reward(reward)
        scaled = reward / np.sqrt(self.ret_rms.var + self.epsilon)
        return _clipped(scaled, self.clip_reward).astype(np.float32)


def _clipped(values: np.ndarray, bound: float) -> np.ndarray:
    return np.minimum(np.maximum(values, -bound), bound)
