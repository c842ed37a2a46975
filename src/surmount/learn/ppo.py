"""PPO of Stable-Baselines3 by a shorter way, able to go on in the middle of an episode."""

from __future__ import annotations

import math
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, cast

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.utils import explained_variance, update_learning_rate
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from surmount.learn.config import LearnerConfig, PerStep
from surmount.learn.decay import Decayed
from surmount.learn.faults import is_sound_update
from surmount.learn.initialisation import initialise
from surmount.learn.mlp import ACTIVATIONS, ActorCritic
from surmount.learn.noise import CorrelatedNoise
from surmount.learn.rollout_collector import RolloutCollector
from surmount.learn.update import Batch, Loss, Objective, ppo_gradients

CLIP_EPSILON = 1e-6
"""Added to the gradient's norm where it is clipped (PyTorch's)."""


@contextmanager
def one_thread() -> Generator[None]:
    """Let PyTorch compute in the calling thread alone.

    Few rows gain nothing from its threads, which after every product spin for a while on the cores
    that the physics engine's threads need.
    """
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


class ResumablePPO(PPO):
    """Stable-Baselines3's PPO whose learning loop is lean, and can be saved and taken up again.

    Stable-Baselines3 saves networks, but not where the loop stood: its last observation and which
    episodes had just begun. With these, and the environments' own state, ``learn`` goes on
    instead of resetting.

    Collecting and updating do what Stable-Baselines3's methods do, drawing the same random
    numbers, and agree with them to rounding, unless the configuration asks for what
    Stable-Baselines3 does not have. They leave out what costs time at nine rows: a tree of modules
    and distribution objects for every step. What they do not know (policies other than
    :class:`ActorCritic`'s, learners not made by :meth:`build`) goes Stable-Baselines3's own way.

    Attributes
    ----------
    skipped_updates
        Updates of the newest roll-out that were left out because they were not sound.
    all_skipped
        Whether none of its updates was made.
    """

    skipped_updates: int = 0
    all_skipped: bool = False
    _config: LearnerConfig | None = None
    _noise: CorrelatedNoise

    @classmethod
    def build(
        cls, env: VecNormalize, config: LearnerConfig, rates: PerStep, seed: int
    ) -> ResumablePPO:
        """Return a new learner; the seed also sets the global generators it draws from.

        Parameters
        ----------
        env
            Environments, normalised.
        config
            Hyper-parameters.
        rates
            Those in seconds, at the environments' step.
        seed
            Of weights, exploration, order of batches and environments.
        """
        limit = config.max_gradient_norm
        learner = cls(
            "MlpPolicy",
            env,
            n_steps=config.rollout_steps,
            batch_size=config.batch_size,
            n_epochs=config.epochs,
            learning_rate=config.learning_rate,
            gamma=rates.discount,
            gae_lambda=rates.gae_lambda,
            clip_range=config.clip_range,
            ent_coef=config.entropy_coefficient,
            vf_coef=config.value_coefficient,
            max_grad_norm=math.inf if limit is None else limit,
            policy_kwargs={
                "net_arch": list(config.hidden_layers),
                "activation_fn": ACTIVATIONS[config.activation].module,
                "optimizer_kwargs": {"eps": config.adam_epsilon, "fused": True},
            },
            device="cpu",
            seed=seed,
        )
        initialise(learner.policy, config)
        learner._config = config
        learner._noise = CorrelatedNoise(rates.noise_correlation)
        return learner

    @property
    def has_begun(self) -> bool:
        """Whether a roll-out has been collected, so that there is a loop state to save."""
        return self._last_obs is not None

    def learn_one_rollout(self) -> None:
        """Collect one roll-out, going on from the last, and update the networks on it."""
        self.learn(self.n_steps * self.n_envs, reset_num_timesteps=False)

    def collect_rollouts(
        self,
        env: VecEnv,
        callback: BaseCallback,
        rollout_buffer: RolloutBuffer,
        n_rollout_steps: int,
    ) -> bool:
        """Fill the buffer with what the present policy does.

        Callbacks find in their locals what they find with Stable-Baselines3, except values and
        densities: these are computed for all steps at once, at the end.

        Returns
        -------
        bool
            False if a callback ended training before the buffer was full.
        """
        networks, config = ActorCritic.of(self.policy), self._config
        if (
            networks is None
            or config is None
            or not isinstance(self.action_space, gymnasium.spaces.Box)
        ):
            return super().collect_rollouts(env, callback, rollout_buffer, n_rollout_steps)
        self.policy.set_training_mode(False)
        rollout_buffer.reset()
        collection = RolloutCollector(
            networks, rollout_buffer, self.action_space, config, self._noise
        )
        observations: Any = self._last_obs
        starts: Any = self._last_episode_starts
        callback.on_rollout_start()
        with one_thread():
            for _ in range(n_rollout_steps):
                new_obs, rewards, dones, infos = env.step(collection.act(observations, starts))
                self.num_timesteps += env.num_envs
                callback.update_locals(locals())
                if not callback.on_step():
                    return False
                self._update_info_buffer(infos, dones)
                collection.add(starts, rewards, dones, infos)
                self._last_obs = observations = cast("Any", new_obs)
                self._last_episode_starts = starts = dones
        collection.finish(observations, starts)
        callback.update_locals(locals())
        callback.on_rollout_end()
        return True

    def train(self) -> None:
        """Update the networks on the collected roll-out."""
        networks, config = ActorCritic.of(self.policy), self._config
        if networks is None or config is None:
            super().train()
            return
        self.policy.set_training_mode(True)
        now = Decayed.at(config, self.num_timesteps)
        update_learning_rate(self.policy.optimizer, now.learning_rate)
        objective = Objective(
            clip_range=now.clip_range,
            entropy_coefficient=now.entropy_coefficient,
            value_coefficient=config.value_coefficient,
            normalise_advantages=config.normalise_advantages == "batch",
            mean_entropy=config.mean_entropy,
            clip_values=config.clip_values,
        )
        gradient = _joint_gradient(self.policy)
        whole = Batch.whole(self.rollout_buffer)
        if config.normalise_advantages == "rollout":
            whole = whole.with_normalised_advantages()
        losses: list[Loss] = []
        self.skipped_updates = 0
        for _ in range(self.n_epochs):
            for batch in whole.shuffled(self.batch_size):
                loss = ppo_gradients(networks, batch, objective)
                norm = torch.linalg.vector_norm(gradient)
                gradient.mul_(torch.clamp(self.max_grad_norm / (norm + CLIP_EPSILON), max=1.0))
                losses.append(loss)
                if is_sound_update(loss.total, norm):
                    self.policy.optimizer.step()
                else:
                    self.skipped_updates += 1
            self._n_updates += 1
        self.all_skipped = self.skipped_updates == len(losses)
        self._log_update(losses, now)

    def _log_update(self, losses: Sequence[Loss], now: Decayed) -> None:
        """Record what Stable-Baselines3 records; the divergence is the last epoch's."""
        buffer, record = self.rollout_buffer, self.logger.record
        last_epoch = losses[-(len(losses) // self.n_epochs) :]
        record("train/learning_rate", now.learning_rate)
        record("train/entropy_loss", _mean([loss.entropy for loss in losses]))
        record("train/policy_gradient_loss", _mean([loss.policy for loss in losses]))
        record("train/value_loss", _mean([loss.value for loss in losses]))
        record("train/approx_kl", _mean([loss.approx_kl for loss in last_epoch]))
        record("train/clip_fraction", _mean([loss.clip_fraction for loss in losses]))
        record("train/loss", losses[-1].total.item())
        record(
            "train/explained_variance",
            explained_variance(buffer.values.flatten(), buffer.returns.flatten()),
        )
        record("train/std", torch.exp(self.policy.log_std).mean().item())
        record("train/n_updates", self._n_updates, exclude="tensorboard")
        record("train/clip_range", now.clip_range)

    def loop_state(self) -> dict[str, Any]:
        """Return where the loop stands and the global generators, as arrays and JSON values."""
        kind, keys, position, has_gauss, gauss = np.random.get_state(legacy=True)  # noqa: NPY002
        noise = self._noise.newest
        return {
            **({} if noise is None else {"noise": noise}),
            "steps": self.num_timesteps,
            "updates": self._n_updates,
            "last_observation": np.asarray(self._last_obs),
            "last_episode_starts": np.asarray(self._last_episode_starts),
            "torch": torch.get_rng_state().numpy(),
            "numpy_keys": np.asarray(keys),
            "numpy": [kind, position, has_gauss, gauss],
        }

    def load_loop_state(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved loop state."""
        self.num_timesteps = int(state["steps"])
        self._n_updates = int(state["updates"])
        self._last_obs = state["last_observation"]
        self._last_episode_starts = state["last_episode_starts"]
        self._noise.newest = state.get("noise")
        torch.set_rng_state(torch.from_numpy(state["torch"]))
        kind, position, has_gauss, gauss = state["numpy"]
        np.random.set_state((kind, state["numpy_keys"], position, has_gauss, gauss))  # noqa: NPY002


def _joint_gradient(policy: torch.nn.Module) -> torch.Tensor:
    """Return one array, shape ``(weight,)``, that the gradients of all weights are parts of."""
    parameters = list(policy.parameters())
    joint = torch.zeros(sum(parameter.numel() for parameter in parameters))
    parts = joint.split([parameter.numel() for parameter in parameters])
    for parameter, part in zip(parameters, parts, strict=True):
        parameter.grad = part.view_as(parameter)
    return joint


def _mean(values: Sequence[torch.Tensor]) -> float:
    return torch.stack(list(values)).mean().item()
