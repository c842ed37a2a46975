"""A curriculum of two levels, and trainings under it whose episodes are written by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
from trainings import TEST, training

from surmount.learn.training_episodes import TrainingEpisodes
from surmount.tasks.curriculum import Box, Curriculum, Group, Level


def group(name, low, high) -> Group:
    box = Box(lower=np.array([low]), upper=np.array([high]), weight=1.0)
    return Group(name=name, variants=np.array([[low]]), success_rate=0.5, boxes=(box,))


CURRICULUM = Curriculum(
    parameters=("height_mm",),
    groups=(group("easy", 0.0, 10.0), group("difficult", 10.5, 20.0)),
    levels=(
        Level(dominant="easy", weights=(0.7, 0.3)),
        Level(dominant="difficult", weights=(0.3, 0.7)),
    ),
    success_threshold=0.95,
)
EXTENDED = dataclasses.replace(TEST, steps=1_000, decision="extend")
FIRST = dataclasses.replace(TEST, steps=2_000)
SECOND = dataclasses.replace(TEST, level=1, steps=4_000)


def taught(easy, difficult):
    """A training whose episodes of each group are (steps, success)."""
    rows = sorted([(*row, 5.0) for row in easy] + [(*row, 15.0) for row in difficult])
    steps, success, tasks = map(np.array, zip(*rows, strict=True))
    record = TrainingEpisodes(
        budget=4_000,
        steps=steps,
        tasks=tasks[:, None],
        success=success.astype(bool),
        reward=np.zeros(steps.size),
        length=np.ones(steps.size, dtype=np.int64),
    )
    tests = (EXTENDED, FIRST, SECOND)
    return dataclasses.replace(training(np.zeros(9)), level_tests=tests, record=record)
