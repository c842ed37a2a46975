"""How far the gain of eq. 5 goes by chance: whether a level test measured learning or noise."""

from __future__ import annotations

import math

import numpy as np

from surmount.report.figures.curves import level_of_rollouts, levels_left_before
from surmount.report.results import TrainingResult
from surmount.teachers.teacher import LevelTest

FEWEST_DIFFERENCES = 8
"""Differences of neighbouring roll-outs or episodes below which no noise is estimated."""
NORMAL_MEDIAN = 1.4826
"""Standard deviation of a normal variable over the median of its magnitude."""
CLEAR = 2.0
"""A gain is told from chance where it is so many times its noise."""


def noise_of_test(test: LevelTest, training: TrainingResult, window_steps: int) -> float | None:
    """Return the standard deviation that a test's newest gain has where nothing is learnt.

    Parameters
    ----------
    test
        By either measure.
    training
        The training in which it was made.
    window_steps
        W: learning steps of each window.

    Returns
    -------
    float or None
        In units of r; ``None`` with too little to tell.
    """
    if test.measure == "step":
        return gain_noise(training, window_steps)
    spread = episode_noise(training)
    if spread is None or not test.first_episodes or not test.last_episodes:
        return None
    return spread * math.sqrt(1 / test.first_episodes + 1 / test.last_episodes)


def episode_noise(training: TrainingResult) -> float | None:
    """Return the standard deviation of the reward of single episodes, learning left out.

    From the mean square of differences between episodes that ended one after the other within a
    level (von Neumann et al. 1941, as below). It holds what tasks, starts and luck make of an
    episode. Odd episodes count as they are: the mean over a window holds them too.

    Parameters
    ----------
    training
        A training under levels whose episodes were recorded.

    Returns
    -------
    float or None
        ``None`` with too few episodes, or none recorded.
    """
    if training.record is None:
        return None
    level = levels_left_before(training, training.record.steps)
    differences = np.diff(training.record.reward)[np.diff(level) == 0]
    if differences.size < FEWEST_DIFFERENCES:
        return None
    return math.sqrt(float(np.square(differences).mean()) / 2)


def gain_noise(training: TrainingResult, window_steps: int) -> float | None:
    """Return the standard deviation of rL − rF by steps where nothing is learnt.

    From successive differences (after von Neumann et al. 1941, Annals of Mathematical Statistics
    12): mean rewards of neighbouring roll-outs within a level differ by chance and hardly by
    learning. Their spread is taken by the median of magnitudes, so that a single roll-out with an
    odd episode does not make it. Roll-outs are taken for independent of each other, and a window
    of W steps for W / n roll-outs of n steps.

    Parameters
    ----------
    training
        A training under levels.
    window_steps
        W: learning steps of each window.

    Returns
    -------
    float or None
        In units of summed reward; ``None`` with too few roll-outs.
    """
    level = level_of_rollouts(training, list(range(training.steps.size)))
    differences = np.diff(training.reward)[np.diff(level) == 0]
    if differences.size < FEWEST_DIFFERENCES:
        return None
    # The difference of two roll-outs' means has the noise of two windows, as a gain has.
    spread = NORMAL_MEDIAN * float(np.median(np.abs(differences)))
    rollout_steps = float(np.median(np.diff(training.steps, prepend=0)))
    return spread * math.sqrt(rollout_steps * window_steps)
