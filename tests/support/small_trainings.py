"""Small trainings under a teacher, and what their tests compare."""

from __future__ import annotations

import numpy as np
from point_env import PointEnv

from surmount.learn.config import LearnerConfig
from surmount.learn.trainer import Trainer
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.uniform import UniformTeacher

CONFIG = LearnerConfig(
    num_envs=4, hidden_layers=(16, 16), rollout_steps=64, batch_size=64, learning_rate=3e-3
)
NEAR = TaskDistribution.uniform(("distance_m",), np.array([0.5]), np.array([1.0]))
FAR = TaskDistribution.uniform(("distance_m",), np.array([2.0]), np.array([3.0]))


def uniform_trainer(steps: int, *, seed: int = 0, start=None) -> Trainer:
    return Trainer(PointEnv(4), UniformTeacher(NEAR, steps), CONFIG, seed=seed, start=start)


def level_trainer() -> Trainer:
    teacher = LevelTeacher(
        [NEAR, FAR],
        AdvancementConfig(
            iteration_steps=1024, extension_steps=512, window_steps=256, max_extensions=1
        ),
    )
    return Trainer(PointEnv(4), teacher, CONFIG, seed=3)


class StopAfter:
    """Asks to stop after a number of roll-outs, as Ctrl-C does."""

    def __init__(self, rollouts: int) -> None:
        self.left = rollouts

    def progress(self, progress) -> None:
        self.left -= 1

    def log(self, sentence: str) -> None:
        pass

    def should_stop(self) -> bool:
        return self.left <= 0


def assert_same_training(first, second) -> None:
    assert first.network.tensors.keys() == second.network.tensors.keys()
    for name, value in first.network.tensors.items():
        np.testing.assert_array_equal(value, second.network.tensors[name], err_msg=name)
    assert first.tests == second.tests
    np.testing.assert_array_equal(first.history.reward, second.history.reward)
    np.testing.assert_array_equal(first.history.episodes.variant, second.history.episodes.variant)
