"""The peer: Stable-Baselines3's PPO as a researcher would set it up, with our hyper-parameters."""

from __future__ import annotations

from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.vec_env import VecNormalize

from surmount.learn.mlp import ACTIVATIONS
from surmount.rstar.course.single import ObstacleEnv


def stock_learner(obstacle, config, seed):
    """Return PPO on single environments in ``Monitor``, ``DummyVecEnv`` and ``VecNormalize``."""
    envs = make_vec_env(lambda: ObstacleEnv(obstacle), n_envs=config.num_envs, seed=seed)
    normalised = VecNormalize(
        envs,
        norm_obs=config.normalise_observations,
        norm_reward=config.normalise_rewards,
        gamma=config.discount,
    )
    return PPO(
        "MlpPolicy",
        normalised,
        n_steps=config.rollout_steps,
        batch_size=config.batch_size,
        n_epochs=config.epochs,
        learning_rate=config.learning_rate,
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
        seed=seed,
    )


class EpisodeLog(BaseCallback):
    """Keeps step, unnormalised reward and success of every episode."""

    def __init__(self):
        super().__init__()
        self.rows = []

    def _on_step(self):
        for done, info in zip(self.locals["dones"], self.locals["infos"], strict=True):
            if done:
                row = (self.num_timesteps, info["episode"]["r"], bool(info["is_success"]))
                self.rows.append(row)
        return True
