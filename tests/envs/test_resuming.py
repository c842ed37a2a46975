"""Interrupted training on somebody's own environment goes on to the same bytes."""

from __future__ import annotations

import numpy as np
import pytest
from own_point import make_env

from surmount.envs.batch import TaskBatch
from surmount.learn.config import LearnerConfig
from surmount.learn.trainer import Checkpointing, Trainer
from surmount.tasks.cells import TaskCells
from surmount.teachers.replay import ReplayConfig, ReplayTeacher
from surmount.workflow.monitor import Interrupted, SilentMonitor

CONFIG = LearnerConfig(num_envs=3, hidden_layers=(8,), rollout_steps=32, batch_size=96)


class StopAfter(SilentMonitor):
    def __init__(self, rollouts):
        self.left = rollouts

    def progress(self, progress):
        self.left -= 1

    def should_stop(self):
        return self.left <= 0


def trainer():
    cells = TaskCells(("distance_m", "wind"), make_env().space.variants)
    teacher = ReplayTeacher(cells, total_steps=900, seed=0, config=ReplayConfig())
    return Trainer(TaskBatch(make_env, 3), teacher, CONFIG, seed=0)


def test_an_interruption_in_the_middle_of_episodes_changes_nothing(tmp_path):
    whole = trainer().run(SilentMonitor())
    checkpointing = Checkpointing(path=tmp_path / "checkpoint.safetensors", interval_steps=96)
    with pytest.raises(Interrupted):
        trainer().run(StopAfter(4), checkpointing)
    resumed = trainer().run(SilentMonitor(), checkpointing)
    for name, value in whole.network.tensors.items():
        np.testing.assert_array_equal(value, resumed.network.tensors[name], err_msg=name)
    np.testing.assert_array_equal(whole.history.episodes.variant, resumed.history.episodes.variant)
