"""Training learns, carries everything from stage to stage, and survives interruption."""

from __future__ import annotations

import numpy as np
import pytest
from point_env import PointEnv
from small_trainings import (
    StopAfter,
    assert_same_training,
    level_trainer,
    uniform_trainer,
)

from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.rollouts import Actor, roll_out
from surmount.learn.trainer import Checkpointing
from surmount.workflow.monitor import Interrupted, SilentMonitor


def success_rate(training, distances) -> float:
    env = PointEnv(len(distances) * 10, autoreset=False)
    actor = Actor(training.network, env.single_observation_space, env.single_action_space)
    trials = roll_out(
        env,
        actor,
        np.array(distances)[:, None],
        RolloutConfig(repetitions=10),
        network=0,
        seed=1,
        monitor=SilentMonitor(),
    )
    return float(trials.success.mean())


def test_training_learns_to_reach_the_goal():
    before = success_rate(uniform_trainer(256).run(SilentMonitor()), [0.6, 0.8, 1.0])
    after = success_rate(uniform_trainer(8_192).run(SilentMonitor()), [0.6, 0.8, 1.0])
    # A driver who goes forward at full speed reaches every one of these distances.
    assert after > 0.9
    assert after > before


@pytest.mark.parametrize("stops", [[1], [3], [2, 5, 6]])
def test_interrupted_training_goes_on_to_the_same_bytes(tmp_path, stops):
    whole = level_trainer().run(SilentMonitor())
    checkpointing = Checkpointing(path=tmp_path / "checkpoint.safetensors", interval_steps=512)
    done = 0
    for stop in stops:
        with pytest.raises(Interrupted):
            level_trainer().run(StopAfter(stop - done), checkpointing)
        done = stop
    assert_same_training(whole, level_trainer().run(SilentMonitor(), checkpointing))


def test_a_killed_run_repeats_at_most_one_checkpoint_interval(tmp_path):
    class Kill(StopAfter):
        def progress(self, progress) -> None:
            super().progress(progress)
            if self.left <= 0:
                raise KeyboardInterrupt  # leaves run() at once, without saving

    whole = level_trainer().run(SilentMonitor())
    checkpointing = Checkpointing(path=tmp_path / "checkpoint.safetensors", interval_steps=512)
    with pytest.raises(KeyboardInterrupt):
        level_trainer().run(Kill(6), checkpointing)  # 6 roll-outs of 256 steps; 5 precede the kill
    logged: list[str] = []

    class Listen(SilentMonitor):
        def log(self, sentence: str) -> None:
            logged.append(sentence)

    resumed = level_trainer().run(Listen(), checkpointing)
    assert "went on from the checkpoint at 1,024 steps" in logged
    assert_same_training(whole, resumed)


def test_weights_optimiser_and_normalisation_carry_over_to_the_next_stage():
    first = uniform_trainer(1024).run(SilentMonitor()).network
    carried = uniform_trainer(0, start=first).run(SilentMonitor()).network
    assert {name.split("/")[0] for name in first.tensors} == {"policy", "optimiser", "normaliser"}
    for name, value in first.tensors.items():
        np.testing.assert_array_equal(value, carried.tensors[name], err_msg=name)
    assert carried.tensors["normaliser/observation/count"] > 1024


def test_seeds_matter_and_repeat():
    one, again, other = (uniform_trainer(512, seed=seed).run(SilentMonitor()) for seed in (1, 1, 2))
    assert_same_training(one, again)
    assert not np.array_equal(
        one.network.tensors["policy/action_net.weight"],
        other.network.tensors["policy/action_net.weight"],
    )


def test_tasks_follow_the_level_across_automatic_resets():
    training = level_trainer().run(SilentMonitor())
    switch = next(test.steps for test in training.tests if test.decision != "extend")
    episodes = training.history.episodes
    # Episodes under way at the switch end with their old task; each environment has one.
    new = episodes.step > switch + 4 * 40
    assert new.any()
    assert (episodes.variant[episodes.step <= switch] <= 1.0).all()
    assert (episodes.variant[new] >= 2.0).all()


def test_rewards_for_the_level_test_are_not_normalised():
    training = uniform_trainer(2048).run(SilentMonitor())
    episodes = training.history.episodes
    # Success pays 5 in the environment; scaled rewards would be far from it.
    assert episodes.success.any()
    assert episodes.reward[episodes.success].max() == pytest.approx(5.0, abs=0.5)
