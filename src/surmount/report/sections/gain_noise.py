"""How far the gain of eq. 5 goes by chance: whether a level test measured learning or noise."""

from __future__ import annotations

import math

import numpy as np

from surmount.report.figures.curves import level_of_rollouts
from surmount.report.results import TrainingResult

FEWEST_DIFFERENCES = 8
"""Differences of neighbouring roll-outs below which no noise is estimated."""
NORMAL_MEDIAN = 1.4826
"""Standard deviation of a normal variable over the median of its magnitude."""
CLEAR = 2.0
"""A gain is told from chance where it is so many times its noise."""


def gain_noise(training: TrainingResult, window_steps: int) -> float | None:
    """Return the standard deviation of rL − rF where nothing is learnt.

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
