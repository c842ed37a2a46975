"""Each of the differences from Stable-Baselines3 does what ML-Agents does, by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
import torch
from lean_ppo import CONFIG, collect, lean_learner, loss_of, update
from point_env import PointEnv
from small_trainings import FAR, NEAR, StopAfter, assert_same_training
from stable_baselines3.common.callbacks import CallbackList

from surmount.core.errors import InputError
from surmount.learn.advantages import cut_advantages
from surmount.learn.decay import Decayed
from surmount.learn.mlp import ActorCritic
from surmount.learn.presets import ml_agents_learner
from surmount.learn.rollouts import Actor
from surmount.learn.snapshot import Snapshot
from surmount.learn.trainer import Checkpointing, Trainer
from surmount.learn.update import Batch, Objective
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.monitor import Interrupted, SilentMonitor

PAPER_LIKE = ml_agents_learner(
    num_envs=4, hidden_layers=(32, 16), rollout_steps=64, batch_size=64, time_horizon=16
)
CORRELATED = replace(
    PAPER_LIKE, discount_time_s=5.0, gae_time_s=1.0, noise_correlation_s=0.2, decay_steps=5_000
)


class WideEnv(PointEnv):
    """Has three actions, of which the first drives."""

    def __init__(self, num_envs: int) -> None:
        super().__init__(num_envs)
        self.single_action_space = gymnasium.spaces.Box(-1, 1, (3,), np.float32)
        self.taken: list[np.ndarray] = []

    def step(self, actions):
        self.taken.append(np.array(actions))
        return super().step(actions)


def small_batch(learner, rows: int = 8) -> Batch:
    rng = np.random.default_rng(0)
    size = learner.action_space.shape[0]

    def draw(*shape):
        return torch.from_numpy(rng.normal(size=shape)).float()

    return Batch(
        observations=draw(rows, 2),
        actions=draw(rows, size),
        log_probs=draw(rows, size) - 1.2,
        values=draw(rows),
        advantages=draw(rows),
        returns=draw(rows),
    )


def objective(**changes) -> Objective:
    return Objective(
        **{"clip_range": 0.2, "entropy_coefficient": 0.0, "value_coefficient": 0.5} | changes
    )


def test_initial_weights_have_the_deviations_of_kaiming_and_the_head_a_fifth():
    config = replace(PAPER_LIKE, hidden_layers=(200, 150))
    policy = lean_learner(config, WideEnv(4)).policy
    body = policy.mlp_extractor
    for net in (body.policy_net, body.value_net):
        # 30,000 numbers: the standard error of their deviation is 0.4 %.
        assert net[2].weight.std().item() == pytest.approx(1 / math.sqrt(200), rel=0.02)
        assert net[0].weight.std().item() == pytest.approx(1 / math.sqrt(2), rel=0.15)
        assert not net[0].bias.any()
    assert policy.action_net.weight.std().item() == pytest.approx(0.2 / math.sqrt(150), rel=0.15)
    bound = math.sqrt(6 / (150 + 1))
    assert 0.9 * bound < policy.value_net.weight.abs().max().item() <= bound
    assert not torch.cat([policy.action_net.bias, policy.value_net.bias, policy.log_std]).any()


def test_an_orthogonal_head_is_scaled():
    usual = lean_learner(CONFIG).policy.action_net.weight
    scaled = lean_learner(replace(CONFIG, policy_head_scale=0.2)).policy.action_net.weight
    torch.testing.assert_close(scaled, 20 * usual)
    assert usual.norm().item() == pytest.approx(0.01, rel=1e-5)


def test_draws_are_divided_by_three_and_kept_as_drawn():
    env = WideEnv(4)
    learner = lean_learner(PAPER_LIKE, env)
    with torch.no_grad():
        learner.policy.log_std.fill_(1.0)
    collect(learner, seed=0)
    drawn = learner.rollout_buffer.actions
    assert (np.abs(drawn) > 3).any()
    np.testing.assert_allclose(np.array(env.taken), np.clip(drawn, -3, 3) / 3, rtol=1e-6)


def test_densities_in_the_buffer_are_those_of_each_action():
    learner = lean_learner(PAPER_LIKE, WideEnv(4))
    collect(learner, seed=0)
    buffer = learner.rollout_buffer
    assert buffer.log_probs.shape == (64, 4, 3)
    with torch.no_grad():
        normal = learner.policy.get_distribution(
            torch.from_numpy(buffer.observations.reshape(-1, 2))
        ).distribution
        expected = normal.log_prob(torch.from_numpy(buffer.actions.reshape(-1, 3)))
    np.testing.assert_allclose(buffer.log_probs.reshape(-1, 3), expected, rtol=1e-4, atol=1e-5)


def test_each_actions_ratio_is_clipped_by_itself():
    learner = lean_learner(PAPER_LIKE, WideEnv(4))
    networks, batch = ActorCritic.of(learner.policy), small_batch(learner)
    loss = loss_of(networks, batch, objective(normalise_advantages=False))
    with torch.no_grad():
        means, std = (
            networks.actor.forward(batch.observations).outputs.numpy(),
            networks.log_std.exp().numpy(),
        )
    terms, outside = [], 0
    for row in range(8):
        for action in range(3):
            z = (batch.actions[row, action].item() - means[row, action]) / std[action]
            log_prob = -0.5 * z**2 - math.log(std[action]) - 0.5 * math.log(2 * math.pi)
            ratio = math.exp(log_prob - batch.log_probs[row, action].item())
            advantage = batch.advantages[row].item()
            outside += abs(ratio - 1) > 0.2
            terms.append(min(ratio * advantage, min(max(ratio, 0.8), 1.2) * advantage))
    assert loss.policy.item() == pytest.approx(-np.mean(terms), rel=1e-5)
    assert loss.clip_fraction.item() == pytest.approx(outside / 24)


def test_with_one_action_both_ratios_are_the_same():
    learner = lean_learner(PAPER_LIKE)
    networks, each = ActorCritic.of(learner.policy), small_batch(learner)
    joint = replace(each, log_probs=each.log_probs[:, 0])
    torch.testing.assert_close(
        vars(loss_of(networks, each, objective())), vars(loss_of(networks, joint, objective()))
    )


def test_the_mean_entropy_does_not_grow_with_the_number_of_actions():
    learner = lean_learner(PAPER_LIKE, WideEnv(4))
    networks, batch = ActorCritic.of(learner.policy), small_batch(learner)
    with torch.no_grad():
        networks.log_std.copy_(torch.tensor([0.1, -0.5, 0.3]))
    loss = loss_of(networks, batch, objective(mean_entropy=True))
    each = [0.5 * math.log(2 * math.pi * math.e) + s for s in (0.1, -0.5, 0.3)]
    assert loss.entropy.item() == pytest.approx(-np.mean(each), rel=1e-6)


def test_the_value_may_not_leave_the_range_around_what_it_was():
    learner = lean_learner(PAPER_LIKE)
    networks, batch = ActorCritic.of(learner.policy), small_batch(learner)
    loss = loss_of(networks, batch, objective(clip_values=True))
    with torch.no_grad():
        values = networks.critic.forward(batch.observations).outputs.flatten().numpy()
    errors = []
    for value, old, target in zip(values, batch.values.numpy(), batch.returns.numpy(), strict=True):
        near = old + min(max(value - old, -0.2), 0.2)
        errors.append(max((value - target) ** 2, (near - target) ** 2))
    assert loss.value.item() == pytest.approx(np.mean(errors), rel=1e-5)
    plain = loss_of(networks, batch, objective()).value.item()
    assert plain == pytest.approx(np.mean((values - batch.returns.numpy()) ** 2), rel=1e-5)
    assert plain < loss.value.item()


def test_advantages_are_standardised_once_over_the_rollout():
    batch = replace(
        small_batch(lean_learner()), advantages=torch.tensor([1.0, 2, 3, 4, 5, 6, 7, 8])
    )
    whole = batch.with_normalised_advantages().advantages.numpy()
    np.testing.assert_allclose(whole, (np.arange(8) - 3.5) / np.std(np.arange(8)), rtol=1e-6)


def test_gradients_are_not_clipped_where_no_norm_is_given():
    config = replace(PAPER_LIKE, epochs=1, batch_size=256)
    weights = {}
    for limit in (None, 1e9, 1e-3):
        learner = lean_learner(replace(config, max_gradient_norm=limit))
        collect(learner, seed=0)
        update(learner, seed=1)
        gradient = torch.cat([p.grad.flatten() for p in learner.policy.parameters()])
        weights[limit] = gradient
    assert torch.equal(weights[None], weights[1e9])
    assert weights[None].norm() > 0.01
    assert weights[1e-3].norm().item() == pytest.approx(1e-3, rel=1e-2)


def test_the_optimiser_has_its_epsilon():
    assert lean_learner(PAPER_LIKE).policy.optimizer.param_groups[0]["eps"] == 1e-8


def test_the_decay_is_linear_down_to_its_floors_and_stays_there():
    config = replace(PAPER_LIKE, decay_steps=1000)
    half = Decayed.at(config, 500)
    assert half.learning_rate == pytest.approx(0.5 * (3e-4 + 1e-10), rel=1e-12)
    assert half.clip_range == pytest.approx(0.15, rel=1e-12)
    assert half.entropy_coefficient == pytest.approx(0.5 * (5e-3 + 1e-5), rel=1e-12)
    for steps in (1000, 5000):
        end = Decayed.at(config, steps)
        assert (end.learning_rate, end.clip_range, end.entropy_coefficient) == (1e-10, 0.1, 1e-5)
    never = Decayed.at(replace(config, decay_steps=None), 10**9)
    assert (never.learning_rate, never.clip_range, never.entropy_coefficient) == (3e-4, 0.2, 5e-3)
    assert Decayed.at(replace(config, clip_range=0.05), 500).clip_range == 0.05


def test_updates_use_what_has_decayed():
    learner = lean_learner(replace(PAPER_LIKE, decay_steps=1024))
    for seed, left in ((0, 0.75), (1, 0.5)):
        collect(learner, seed=seed)
        logged = update(learner, seed=seed)
        assert logged["train/learning_rate"] == pytest.approx(3e-4 * left, rel=1e-5)
        assert logged["train/clip_range"] == pytest.approx(0.1 + 0.1 * left, rel=1e-12)
        assert learner.policy.optimizer.param_groups[0]["lr"] == logged["train/learning_rate"]


def segment_advantages(rewards, values, next_value, discount, gae_lambda):
    """Return one trajectory's advantages by the definition: sums of discounted errors."""
    following = np.append(values[1:], next_value)
    errors = rewards + discount * following - values
    return [
        sum((discount * gae_lambda) ** k * error for k, error in enumerate(errors[start:]))
        for start in range(len(errors))
    ]


def test_a_cut_trajectory_leans_on_the_value_of_what_comes_next():
    rng = np.random.default_rng(4)
    rewards, values = rng.normal(size=(2, 12, 1))
    starts = np.zeros((12, 1), dtype=bool)
    starts[[0, 7]] = True
    found = cut_advantages(
        rewards,
        values,
        starts,
        np.array([0.3]),
        np.array([False]),
        discount=0.9,
        gae_lambda=0.8,
        horizon=4,
    )
    r, v = rewards[:, 0], values[:, 0]
    # The first episode ends after step 6; it is cut after 4 steps, the second one after step 10.
    pieces = [(0, 4, v[4]), (4, 7, 0.0), (7, 11, v[11]), (11, 12, 0.3)]
    expected = [
        advantage
        for begin, end, following in pieces
        for advantage in segment_advantages(r[begin:end], v[begin:end], following, 0.9, 0.8)
    ]
    np.testing.assert_allclose(found[:, 0], expected, rtol=1e-12)


def test_a_horizon_beyond_the_rollout_changes_nothing():
    cut, whole = (lean_learner(replace(PAPER_LIKE, time_horizon=horizon)) for horizon in (64, None))
    for learner in (cut, whole):
        collect(learner, seed=0)
    for name in ("advantages", "returns"):
        np.testing.assert_allclose(
            getattr(cut.rollout_buffer, name), getattr(whole.rollout_buffer, name), rtol=1e-5
        )


def test_credit_in_seconds_reaches_buffer_and_normalisation():
    config = replace(CONFIG, discount_time_s=5.0, gae_time_s=1.0)
    model = Trainer(PointEnv(4), UniformTeacher(NEAR, 0), config, seed=0)._model
    assert model.gamma == model.rollout_buffer.gamma == pytest.approx(math.exp(-0.01))
    assert model.rollout_buffer.gae_lambda == pytest.approx(math.exp(-0.05))
    assert model.get_env().gamma == model.gamma


def test_noise_of_a_rollout_is_an_ar_process_that_begins_with_each_episode():
    learner, rho = lean_learner(CORRELATED, WideEnv(4)), math.exp(-0.05 / 0.2)
    torch.manual_seed(9)
    fresh = torch.stack([torch.empty(4, 3).normal_() for _ in range(128)]).numpy()
    state = torch.get_rng_state()
    expected = np.zeros((4, 3))
    restarts = 0
    torch.manual_seed(9)
    for part in range(2):
        learner.collect_rollouts(
            learner.env, _no_callback(learner), learner.rollout_buffer, learner.n_steps
        )
        buffer = learner.rollout_buffer
        with torch.no_grad():
            actor = ActorCritic.of(learner.policy).actor
            means = actor.forward(torch.from_numpy(buffer.observations)).outputs
        noise = buffer.actions - means.numpy()  # a new policy's standard deviation is 1
        for step in range(64):
            begins = buffer.episode_starts[step].astype(bool)[:, None]
            drawn = fresh[64 * part + step]
            restarts += int(begins.sum())
            expected = np.where(begins, drawn, rho * expected + math.sqrt(1 - rho**2) * drawn)
            np.testing.assert_allclose(noise[step], expected, atol=2e-5)
    assert restarts > 8  # the first episodes, and others that began on the way
    assert torch.equal(torch.get_rng_state(), state)


def _no_callback(learner):
    callback = CallbackList([])
    callback.init_callback(learner)
    return callback


@pytest.mark.parametrize("stops", [[1], [2, 5]])
def test_interrupted_training_goes_on_to_the_same_bytes(tmp_path, stops):
    def trainer() -> Trainer:
        teacher = LevelTeacher(
            [NEAR, FAR],
            AdvancementConfig(
                iteration_steps=1024, extension_steps=512, window_steps=256, max_extensions=1
            ),
        )
        return Trainer(PointEnv(4), teacher, CORRELATED, seed=3)

    whole = trainer().run(SilentMonitor())
    checkpointing = Checkpointing(path=tmp_path / "checkpoint.safetensors", interval_steps=512)
    done = 0
    for stop in stops:
        with pytest.raises(Interrupted):
            trainer().run(StopAfter(stop - done), checkpointing)
        done = stop
    assert_same_training(whole, trainer().run(SilentMonitor(), checkpointing))


def trained(config, steps: int = 256):
    return Trainer(PointEnv(4), UniformTeacher(NEAR, steps), config, seed=0).run(SilentMonitor())


def actor_of(network: Snapshot) -> Actor:
    env = PointEnv(1)
    return Actor(network, env.single_observation_space, env.single_action_space)


def test_a_network_says_how_it_acted_only_where_that_is_unusual():
    usual, other = trained(CONFIG).network, trained(CORRELATED).network
    assert usual.record.keys() == {"hidden_layers", "activation", "normalise_observations"}
    assert other.record["action_divisor"] == 3.0
    assert other.record["exploration_noise"] == {"correlation_s": 0.2, "step_s": 0.05}
    assert actor_of(usual).noise_correlation == 0.0
    assert actor_of(other).noise_correlation == pytest.approx(math.exp(-0.25))


def test_trials_act_as_the_network_learnt_to():
    network = trained(CORRELATED).network
    observations, noise = np.array([[0.0, 2.0], [1.0, 2.0]]), np.array([[2.0], [-5.0]])
    plain = {name: v for name, v in network.record.items() if name != "action_divisor"}
    means = actor_of(Snapshot(tensors=network.tensors, record=plain)).act(observations, None)
    std = np.exp(network.tensors["policy/log_std"])
    assert (np.abs(means) < 1).all()
    acted = actor_of(network).act(observations, noise)
    np.testing.assert_allclose(acted, np.clip((means + std * noise) / 3, -1, 1), rtol=1e-6)


@pytest.mark.parametrize(
    "spoilt",
    [
        {"action_divisor": 0},
        {"action_divisor": "3"},
        {"exploration_noise": 0.1},
        {"exploration_noise": {"correlation_s": 0.1}},
        {"exploration_noise": {"correlation_s": -1, "step_s": 0.01}},
    ],
)
def test_a_record_that_makes_no_sense_is_refused(spoilt):
    network = trained(CORRELATED, 0).network
    with pytest.raises(InputError, match=next(iter(spoilt))):
        actor_of(Snapshot(tensors=network.tensors, record={**network.record, **spoilt}))


def test_the_paper_like_learner_learns():
    config = replace(PAPER_LIKE, learning_rate=3e-3, gae_time_s=1.0)
    success = [
        float(trained(config, steps).history.episodes.success[-50:].mean())
        for steps in (1024, 8_192)
    ]
    assert success[1] > 0.9
    assert success[1] > success[0]
