"""Value errors are those of whole episodes, wherever roll-outs cut them, and reach the teacher."""

from __future__ import annotations

import numpy as np
from point_env import PointEnv

from surmount.learn.config import LearnerConfig
from surmount.learn.trainer import Trainer
from surmount.learn.value_errors import EpisodeErrors
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.monitor import SilentMonitor


def test_an_episode_over_several_rollouts_counts_as_one():
    rng = np.random.default_rng(0)
    whole = rng.standard_normal((60, 3))
    ends = [(7, 0), (12, 2), (25, 0), (25, 1), (44, 2), (59, 1)]
    expected = []
    begin = [0, 0, 0]
    for step, env in ends:
        expected.append(np.abs(whole[begin[env] : step + 1, env]).mean())
        begin[env] = step + 1
    found: list[float] = []
    errors = EpisodeErrors(3)
    for start in range(0, 60, 20):
        if start == 40:  # saved and taken up again
            state, errors = errors.state_dict(), EpisodeErrors(3)
            errors.load_state_dict(state)
        inside = [(step - start, env) for step, env in ends if start <= step < start + 20]
        found += errors.add(whole[start : start + 20], inside).tolist()
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_the_trainer_gives_every_episode_its_error():
    told = []

    class Listening(UniformTeacher):
        def update_on_rollout(self, outcome):
            told.append(outcome)
            super().update_on_rollout(outcome)

    near = TaskDistribution.uniform(("distance_m",), np.array([0.5]), np.array([1.0]))
    config = LearnerConfig(num_envs=4, hidden_layers=(8,), rollout_steps=64, batch_size=64)
    trainer = Trainer(PointEnv(4), Listening(near, 1024), config, seed=0)
    trainer.run(SilentMonitor())
    assert sum(outcome.episodes.step.size for outcome in told) > 20
    for outcome in told:
        assert outcome.value_errors.shape == outcome.episodes.step.shape
        assert (outcome.value_errors > 0).all()
    last = np.abs(trainer._model.rollout_buffer.advantages)
    assert last.min() < told[-1].value_errors.mean() < last.max()
