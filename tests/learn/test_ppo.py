"""The lean learner is Stable-Baselines3's PPO, to rounding."""

from __future__ import annotations

from dataclasses import replace

import gymnasium
import numpy as np
import pytest
import torch
from lean_ppo import COLUMNS, CONFIG, RESULTS, collect, lean_learner, stock_learner, update
from point_env import MAX_STEPS, PointEnv
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import DummyVecEnv

from surmount.core.errors import LearningError
from surmount.learn.mlp import ActorCritic
from surmount.learn.ppo import ResumablePPO


@pytest.mark.parametrize(
    "config",
    [
        CONFIG,
        replace(CONFIG, activation="silu", normalise_observations=False),
    ],
    ids=["normalised", "plain"],
)
def test_rollouts_are_those_of_stable_baselines3(config):
    lean, stock = lean_learner(config), stock_learner(config)
    for seed in (0, 1):
        for learner in (lean, stock):
            assert collect(learner, seed=seed)
        for name in (*COLUMNS, *RESULTS):
            # Single precision, over 64 steps each of which builds on the last.
            np.testing.assert_allclose(
                getattr(lean.rollout_buffer, name),
                getattr(stock.rollout_buffer, name),
                rtol=1e-4,
                atol=1e-4,
                err_msg=name,
            )
    for ours, theirs in zip(lean.ep_info_buffer, stock.ep_info_buffer, strict=True):
        assert ours == pytest.approx(theirs, abs=1e-4)
    assert lean.ep_success_buffer == stock.ep_success_buffer
    assert lean.num_timesteps == stock.num_timesteps == 2 * config.steps_per_rollout


def test_what_an_episode_cut_short_would_have_brought_is_valued_and_a_success_is_not():
    class Watch(BaseCallback):
        """Keeps rewards and last observations as the environments return them."""

        def __init__(self) -> None:
            super().__init__()
            self.steps: list[tuple] = []

        def _on_step(self) -> bool:
            local = self.locals
            self.steps.append((local["rewards"].copy(), local["dones"], local["infos"]))
            return True

    lean, watch = lean_learner(), Watch()
    collect(lean, seed=0, callback=watch)
    kinds = {True: 0, False: 0}
    for row, (rewards, dones, infos) in zip(lean.rollout_buffer.rewards, watch.steps, strict=True):
        expected = rewards.copy()
        for env in np.flatnonzero(dones):
            truncated = infos[env]["TimeLimit.truncated"]
            kinds[truncated] += 1
            if truncated:
                assert infos[env]["episode"]["l"] == MAX_STEPS
                last = torch.from_numpy(infos[env]["terminal_observation"][None])
                expected[env] += CONFIG.discount * lean.policy.predict_values(last).item()
        np.testing.assert_allclose(row, expected, rtol=1e-5, atol=1e-6)
    assert min(kinds.values()) > 0


@pytest.mark.parametrize("activation", ["tanh", "relu", "silu"])
def test_an_update_is_that_of_stable_baselines3(activation):
    config = replace(CONFIG, activation=activation)
    lean, stock = lean_learner(config), stock_learner(config)
    collect(stock, seed=0)
    for name in (*COLUMNS, *RESULTS):
        setattr(lean.rollout_buffer, name, getattr(stock.rollout_buffer, name).copy())
    lean.rollout_buffer.full = True
    before = {name: value.clone() for name, value in lean.policy.state_dict().items()}
    ours, theirs = update(lean, seed=1), update(stock, seed=1)
    for name, value in stock.policy.state_dict().items():
        # Steps of Adam are about the learning rate, 3e-4, each; there are 12 of them.
        torch.testing.assert_close(
            lean.policy.state_dict()[name], value, rtol=1e-5, atol=3e-7, msg=name
        )
        assert not torch.equal(value, before[name])
    moments = [learner.policy.optimizer.state_dict()["state"] for learner in (lean, stock)]
    for index, parameter in moments[1].items():
        for name, value in parameter.items():
            torch.testing.assert_close(moments[0][index][name], value, rtol=1e-3, atol=1e-7)
    assert ours.keys() == theirs.keys()
    for name, value in theirs.items():
        assert ours[name] == pytest.approx(value, rel=1e-4, abs=1e-6), name


def test_the_optimiser_is_that_of_stable_baselines3():
    ours, theirs = (
        learner.policy.optimizer.param_groups[0] for learner in (lean_learner(), stock_learner())
    )
    assert {
        name: (ours[name], value)
        for name, value in theirs.items()
        if name != "params" and ours[name] != value
    } == {"fused": (True, None)}


def test_policies_of_another_kind_go_stable_baselines3s_way():
    env = DummyVecEnv([lambda: gymnasium.make("CartPole-v1")] * 2)
    learner = ResumablePPO("MlpPolicy", env, n_steps=32, batch_size=32, device="cpu", seed=0)
    assert ActorCritic.of(learner.policy) is None
    before = learner.policy.action_net.weight.detach().clone()
    learner.learn(64)
    assert not torch.equal(before, learner.policy.action_net.weight)


def test_a_callback_can_end_the_rollout():
    class StopAtThird(BaseCallback):
        def _on_step(self) -> bool:
            return self.n_calls < 3

    lean = lean_learner()
    assert not collect(lean, seed=0, callback=StopAtThird())
    assert lean.num_timesteps == 3 * CONFIG.num_envs


def test_stepping_leaves_the_cores_to_the_environment_and_the_update_has_them_back():
    during: list[int] = []

    class Watched(PointEnv):
        def step(self, actions):
            during.append(torch.get_num_threads())
            return super().step(actions)

    class Fails(BaseCallback):
        def _on_step(self) -> bool:
            raise RuntimeError

    before = torch.get_num_threads()
    try:
        torch.set_num_threads(2)
        collect(lean_learner(env=Watched(4)), seed=0)
        assert set(during) == {1}
        assert torch.get_num_threads() == 2
        with pytest.raises(RuntimeError):
            collect(lean_learner(), seed=0, callback=Fails())
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before)


def test_an_observation_that_is_not_finite_is_refused_with_a_sentence():
    class Broken(PointEnv):
        def step(self, actions):
            observations, *rest = super().step(actions)
            observations[1, 0] = np.nan
            return observations, *rest

    with pytest.raises(LearningError, match="observation or a reward that is not finite"):
        collect(lean_learner(env=Broken(4)), seed=0)
