"""Generalised advantages over trajectories that are cut after a number of steps."""

from __future__ import annotations

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray


def last_before_cut(starts: BoolArray, horizon: int) -> BoolArray:
    """Return the steps after which a trajectory is cut, ``(step, env)``.

    Parameters
    ----------
    starts
        Whether an episode begins with a step, ``(step, env)``.
    horizon
        Steps of a trajectory, counted from the first step and from each beginning.
    """
    steps = np.arange(len(starts))[:, None]
    began = np.maximum.accumulate(np.where(starts, steps, 0), axis=0)
    return (steps - began) % horizon == horizon - 1


def cut_advantages(
    rewards: FloatArray,
    values: FloatArray,
    starts: BoolArray,
    last_values: FloatArray,
    dones: BoolArray,
    *,
    discount: float,
    gae_lambda: float,
    horizon: int,
) -> FloatArray:
    """Return generalised advantages (Schulman et al. 2016), summed up to each cut.

    The step before a cut is credited with its reward and the value of what comes next, the
    ones before it with what they lead to up to there, as ML-Agents' ``time_horizon`` does.

    Parameters
    ----------
    rewards, values, starts
        Of each step, ``(step, env)``.
    last_values, dones
        Value of what follows the last step, and whether its episode ended, ``(env,)``.
    discount, gae_lambda
        γ and λ per step.
    horizon
        Steps of a trajectory.
    """
    goes_on = 1.0 - np.concatenate([starts[1:], dones[None]]).astype(values.dtype)
    next_values = np.concatenate([values[1:], last_values[None]])
    errors = rewards + discount * next_values * goes_on - values
    passed = discount * gae_lambda * goes_on * ~last_before_cut(starts, horizon)
    advantages = np.empty_like(values)
    carried = np.zeros_like(last_values)
    for step in reversed(range(len(rewards))):
        advantages[step] = carried = errors[step] + passed[step] * carried
    return advantages
