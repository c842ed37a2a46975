"""Results of trainings without a run."""

from __future__ import annotations

import numpy as np

from surmount.report.results import TrainingResult
from surmount.teachers.teacher import LevelTest

ROLLOUT = 1_000
TEST = LevelTest(
    level=0, iteration=0, steps=200 * ROLLOUT, first_window=0.0, last_window=0.0, first_gain=0.0,
    newest_gain=0.0, ratio=None, threshold=0.1, decision="advance", sentence="",
)  # fmt: skip


def training(reward, tests=()) -> TrainingResult:
    return TrainingResult(
        steps=ROLLOUT * np.arange(1, reward.size + 1),
        reward=reward,
        success=(None,) * reward.size,
        label=("",) * reward.size,
        total_steps=ROLLOUT * reward.size,
        episodes=1,
        diverged_episodes=0,
        level_tests=tuple(tests),
    )
