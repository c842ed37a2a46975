"""Numbers that go wrong are stopped from spreading, counted, and end with a sentence."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from point_env import PointEnv
from small_trainings import CONFIG, NEAR, StopAfter, assert_same_training, uniform_trainer

from surmount.core.errors import InputError, IntegrityError, LearningError
from surmount.envs.registry import find_family
from surmount.learn import ppo as ppo_module
from surmount.learn.faults import LARGEST_LOSS, MOST_IN_A_ROW, is_sound_update
from surmount.learn.snapshot import Snapshot
from surmount.learn.trainer import Checkpointing, Trainer
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.monitor import Interrupted, SilentMonitor

UPDATES = CONFIG.epochs * CONFIG.steps_per_rollout // CONFIG.batch_size
"""Updates per roll-out."""


class Listener(SilentMonitor):
    def __init__(self) -> None:
        self.sentences: list[str] = []

    def log(self, sentence: str) -> None:
        self.sentences.append(sentence)


def spoil_losses(monkeypatch, which, factor: float) -> None:
    """Multiply the losses of some updates, counted from 0, by a number."""
    honest, calls = ppo_module.ppo_gradients, iter(range(10**6))

    def spoiled(*arguments, **options):
        loss = honest(*arguments, **options)
        if next(calls) in which:
            object.__setattr__(loss, "total", loss.total * factor)
        return loss

    monkeypatch.setattr(ppo_module, "ppo_gradients", spoiled)


@pytest.mark.parametrize("factor", [float("nan"), float("inf"), 1e12])
def test_an_unsound_update_is_left_out_and_learning_goes_on(monkeypatch, factor):
    spoil_losses(monkeypatch, {3, UPDATES + 1}, factor)
    listener = Listener()
    training = uniform_trainer(1024).run(listener)
    assert training.faults.skipped_updates == 2
    assert training.faults.undone_rollouts == 0
    assert training.history.steps[-1] == 1024
    assert all(np.isfinite(value).all() for value in training.network.tensors.values())
    assert sum("1 update(s) left out" in sentence for sentence in listener.sentences) == 2


def test_a_gradient_that_is_not_finite_is_left_out(monkeypatch):
    honest, calls = ppo_module.ppo_gradients, iter(range(10**6))

    def spoiled(networks, batch, objective):
        loss = honest(networks, batch, objective)
        if next(calls) == 5:
            networks.log_std.grad[:] = float("nan")
        return loss

    monkeypatch.setattr(ppo_module, "ppo_gradients", spoiled)
    training = uniform_trainer(512).run(SilentMonitor())
    assert training.faults.skipped_updates == 1
    assert all(np.isfinite(value).all() for value in training.network.tensors.values())


def break_policy(trainer: Trainer, rollouts) -> None:
    """Let the weights be NaN after some roll-outs, counted from 0."""
    model = trainer._model
    honest, calls = model.train, iter(range(10**6))

    def train():
        honest()
        if next(calls) in rollouts:
            with torch.no_grad():
                model.policy.action_net.weight[:] = float("nan")

    model.train = train


def test_a_policy_that_is_not_finite_is_put_back_to_where_it_was():
    trainer = uniform_trainer(1024)
    before = {}
    break_policy(trainer, {1})
    honest = trainer._model.learn

    def learn(*arguments, **options):
        before[trainer._recorder.steps] = trainer._model.policy.action_net.weight.detach().clone()
        return honest(*arguments, **options)

    trainer._model.learn = learn
    listener = Listener()
    training = trainer.run(listener)
    assert training.faults.undone_rollouts == 1
    assert torch.equal(before[512], before[256])  # the second of four roll-outs left nothing
    assert not torch.equal(before[768], before[512])
    assert training.history.steps[-1] == 1024
    assert "the roll-out that ended at 512 steps was undone" in listener.sentences


def test_learning_that_stays_broken_ends_with_the_last_good_checkpoint(tmp_path):
    checkpointing = Checkpointing(path=tmp_path / "checkpoint.safetensors", interval_steps=256)
    trainer = uniform_trainer(4096)
    break_policy(trainer, range(2, 100))
    with pytest.raises(LearningError, match=f"undone {MOST_IN_A_ROW} times in a row") as caught:
        trainer.run(SilentMonitor(), checkpointing)
    assert str(checkpointing.path) in caught.value.remedy
    saved = Snapshot.load(checkpointing.path, sealed=True)
    assert all(
        np.isfinite(value).all() for name, value in saved.tensors.items() if "policy/" in name
    )


def test_counts_of_faults_survive_an_interruption(tmp_path, monkeypatch):
    checkpointing = Checkpointing(path=tmp_path / "checkpoint.safetensors", interval_steps=256)
    spoil_losses(monkeypatch, {0}, float("nan"))
    with pytest.raises(Interrupted):
        uniform_trainer(1024).run(StopAfter(2), checkpointing)
    resumed = uniform_trainer(1024).run(SilentMonitor(), checkpointing)
    assert resumed.faults.skipped_updates == 1


def test_healthy_learning_counts_no_fault():
    assert not uniform_trainer(512).run(SilentMonitor()).faults.occurred


def test_physics_that_always_diverges_ends_learning():
    class Diverging(PointEnv):
        def step(self, actions):
            observations, rewards, terminated, truncated, infos = super().step(actions)
            if "final_info" in infos:
                infos["final_info"]["diverged"] = np.ones(self.num_envs, dtype=bool)
            return observations, rewards, terminated, truncated, infos

    trainer = Trainer(Diverging(4), UniformTeacher(NEAR, 10**5), CONFIG, seed=0)
    with pytest.raises(LearningError, match=r"the physics diverged.*`surmount check`"):
        trainer.run(SilentMonitor())


def test_the_family_of_tasks_says_what_to_do_about_its_physics():
    for name in ("step", "all"):
        assert "env.robot.physics_step_s" in find_family(f"rstar/{name}").diverged_remedy


def test_a_network_that_is_not_finite_is_no_start():
    network = uniform_trainer(256).run(SilentMonitor()).network
    spoiled = {name: value.copy() for name, value in network.tensors.items()}
    spoiled["policy/action_net.bias"][0] = np.nan
    with pytest.raises(InputError, match="not finite"):
        uniform_trainer(256, start=Snapshot(tensors=spoiled, record=network.record))


@pytest.mark.parametrize("damage", ["edit", "truncate"])
def test_a_damaged_checkpoint_is_named_and_not_used(tmp_path, damage):
    checkpointing = Checkpointing(path=tmp_path / "checkpoint.safetensors", interval_steps=256)
    with pytest.raises(Interrupted):
        uniform_trainer(1024).run(StopAfter(2), checkpointing)
    whole = checkpointing.path.read_bytes()
    middle = len(whole) // 2
    damaged = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
    checkpointing.path.write_bytes(damaged if damage == "edit" else whole[:-1])
    with pytest.raises(IntegrityError, match=r"checkpoint\.safetensors") as caught:
        uniform_trainer(1024).run(SilentMonitor(), checkpointing)
    assert "Delete" in caught.value.remedy
    checkpointing.path.write_bytes(whole)
    assert_same_training(
        uniform_trainer(1024).run(SilentMonitor()),
        uniform_trainer(1024).run(SilentMonitor(), checkpointing),
    )


def test_limits_of_a_sound_update():
    one = torch.tensor(1.0)
    assert is_sound_update(torch.tensor(-LARGEST_LOSS), one)
    for loss, norm in [
        (2 * LARGEST_LOSS, 1.0),
        (float("nan"), 1.0),
        (1.0, float("inf")),
        (1.0, float("nan")),
    ]:
        assert not is_sound_update(torch.tensor(loss), torch.tensor(norm))
