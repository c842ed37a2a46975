"""How soon training episodes of each group succeed, from the record of all episodes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.learn.training_episodes import TrainingEpisodes
from surmount.stats.thresholds import StepsToThreshold, steps_to_threshold
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.regions import Regions

EVALUATIONS = 40
"""Moments, evenly over the longest training, at which success in training is looked at."""
WINDOW = 30
"""Newest episodes of a group that make its success in training."""
FEWEST = 10
"""Episodes of a group below which its success in training counts as not known."""


def steps_to_95(
    trainings: Sequence[TrainingEpisodes], curriculum: Curriculum
) -> list[StepsToThreshold]:
    """Return for each group when 95 % of its newest training episodes succeeded.

    Parameters
    ----------
    trainings
        Of all networks of one arm or teacher.
    curriculum
        Whose groups the tasks are sorted into.
    """
    regions = Regions.of(curriculum)
    longest = max(1, *(training.budget for training in trainings))
    moments = np.linspace(0, longest, EVALUATIONS + 1)[1:]
    rates = np.zeros((len(curriculum.groups), len(trainings), EVALUATIONS))
    for network, training in enumerate(trainings):
        owner = regions.index(training.tasks)
        for group in range(len(curriculum.groups)):
            own = owner == group
            rates[group, network] = success_in_training(
                training.steps[own], training.success[own], moments
            )
    return [steps_to_threshold(moments, of_group) for of_group in rates]


def success_in_training(steps: IntArray, success: BoolArray, moments: FloatArray) -> FloatArray:
    """Return the success of the newest :data:`WINDOW` episodes at each moment.

    0 as long as there are fewer than :data:`FEWEST`.

    Parameters
    ----------
    steps, success
        Of a group's episodes in the order in which they ended, ``(episode,)``.
    moments
        Learning steps, ``(moment,)``.
    """
    rates = np.zeros(moments.size)
    for index, ended in enumerate(np.searchsorted(steps, moments, side="right")):
        if ended >= FEWEST:
            rates[index] = success[max(0, ended - WINDOW) : ended].mean()
    return rates
