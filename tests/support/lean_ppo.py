"""The lean learner and Stable-Baselines3's own, side by side, and one step of each."""

from __future__ import annotations

import numpy as np
import torch
from point_env import PointEnv
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import CallbackList
from stable_baselines3.common.logger import configure
from stable_baselines3.common.vec_env import VecNormalize

from surmount.learn.config import LearnerConfig
from surmount.learn.mlp import ACTIVATIONS, ActorCritic
from surmount.learn.normaliser import Normaliser
from surmount.learn.ppo import ResumablePPO
from surmount.learn.recorder import Recorder
from surmount.learn.update import Batch, Loss, Objective, ppo_loss

CONFIG = LearnerConfig(num_envs=4, hidden_layers=(32, 16), rollout_steps=64, batch_size=64)
COLUMNS = ("observations", "actions", "rewards", "episode_starts", "values", "log_probs")
RESULTS = ("advantages", "returns")


def lean_learner(config: LearnerConfig = CONFIG, env=None) -> ResumablePPO:
    normaliser = Normaliser(
        Recorder(env or PointEnv(config.num_envs)),
        observations=config.normalise_observations,
        rewards=config.normalise_rewards,
        discount=config.discount,
    )
    rates = config.at_interval(PointEnv.step_s)
    return ready(ResumablePPO.build(normaliser, config, rates, seed=5))


def stock_learner(config: LearnerConfig = CONFIG) -> PPO:
    normaliser = VecNormalize(
        Recorder(PointEnv(config.num_envs)),
        norm_obs=config.normalise_observations,
        norm_reward=config.normalise_rewards,
        gamma=config.discount,
    )
    learner = PPO(
        "MlpPolicy",
        normaliser,
        n_steps=config.rollout_steps,
        batch_size=config.batch_size,
        n_epochs=config.epochs,
        gamma=config.discount,
        gae_lambda=config.gae_lambda,
        clip_range=config.clip_range,
        ent_coef=config.entropy_coefficient,
        vf_coef=config.value_coefficient,
        max_grad_norm=config.max_gradient_norm,
        policy_kwargs={
            "net_arch": list(config.hidden_layers),
            "activation_fn": ACTIVATIONS[config.activation].module,
        },
        device="cpu",
        seed=5,
    )
    return ready(learner)


def ready(learner):
    """Do what ``learn`` does before its first roll-out."""
    learner.set_logger(configure(None, []))
    learner._setup_learn(10_000)
    return learner


def collect(learner, *, seed: int, callback=None) -> bool:
    torch.manual_seed(seed)
    callback = callback or CallbackList([])
    callback.init_callback(learner)
    return learner.collect_rollouts(learner.env, callback, learner.rollout_buffer, learner.n_steps)


def update(learner, *, seed: int) -> dict[str, float]:
    np.random.seed(seed)  # noqa: NPY002 - Stable-Baselines3 draws the order of batches from it
    learner.train()
    return dict(learner.logger.name_to_value)


def loss_of(networks: ActorCritic, batch: Batch, objective: Objective) -> Loss:
    """Return the loss alone."""
    with torch.no_grad():
        means = networks.actor.forward(batch.observations).outputs
        values = networks.critic.forward(batch.observations).outputs.flatten()
        return ppo_loss(means, values, networks.log_std, batch, objective)[0]
