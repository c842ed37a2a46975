"""A roll-out under way: steps by the present policy, and what came of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.buffers import RolloutBuffer

from surmount.core.errors import LearningError
from surmount.learn.advantages import cut_advantages
from surmount.learn.config import LearnerConfig
from surmount.learn.gaussian import log_densities_of_noise, log_density_of_noise
from surmount.learn.mlp import ActorCritic
from surmount.learn.noise import CorrelatedNoise

VALUED_AT_ONCE = 1024
"""Observations that go through the critic in one product: enough for full speed."""


class RolloutCollector:
    """Fills a roll-out buffer of Stable-Baselines3.

    Weights do not change while a roll-out is collected. So only the actor is asked at every
    step; what needs the critic, and the densities of the actions, wait until :meth:`finish`,
    where thousands of rows share each matrix product.

    Parameters
    ----------
    networks
        The policy that acts.
    buffer
        An empty buffer.
    action_space
        Actions given to the environments are divided as configured and clipped to it, those in the
        buffer are as drawn.
    config
        The learner's; its times in seconds are not read here.
    noise
        Correlates the exploration noise over time, going on from the roll-out before.
    """

    def __init__(
        self,
        networks: ActorCritic,
        buffer: RolloutBuffer,
        action_space: gymnasium.spaces.Box,
        config: LearnerConfig,
        noise: CorrelatedNoise,
    ) -> None:
        self._buffer = buffer
        self._config = config
        self._correlated = noise
        self._actor, self._critic = networks.actor.frozen(), networks.critic.frozen()
        self._log_std = networks.log_std.detach().clone()
        self._std = self._log_std.exp()
        self._low, self._high = action_space.low, action_space.high
        rows = buffer.n_envs
        # PyTorch aligns its memory always alike; sums in the products may depend on that.
        self._inputs = torch.empty(rows, int(np.prod(buffer.obs_shape)))
        self._entries = self._inputs.numpy()
        self._noise = torch.empty(buffer.buffer_size, rows, buffer.action_dim)
        self._step = 0
        self._cut_short: list[tuple[int, int]] = []
        self._last_observations: list[np.ndarray] = []

    def act(self, observations: np.ndarray, episode_starts: np.ndarray) -> np.ndarray:
        """Draw actions, shape ``(env, action)``, within the action space.

        Parameters
        ----------
        observations
            Shape ``(env, observation)``.
        episode_starts
            Whether the episodes have just begun, ``(env,)``.
        """
        noise = self._noise[self._step].normal_()
        noise.copy_(torch.from_numpy(self._correlated.next(noise.numpy(), episode_starts)))
        self._entries[:] = observations.reshape(self._entries.shape)
        drawn = torch.addcmul(self._actor(self._inputs), self._std, noise).numpy()
        self._buffer.observations[self._step] = observations
        self._buffer.actions[self._step] = drawn
        scaled = drawn / self._config.action_divisor
        return np.minimum(np.maximum(scaled, self._low), self._high)

    def add(
        self,
        episode_starts: np.ndarray,
        rewards: np.ndarray,
        dones: np.ndarray,
        infos: Sequence[Mapping[str, Any]],
    ) -> None:
        """Keep what came of the last actions.

        Parameters
        ----------
        episode_starts
            Whether the episodes had just begun when they were acted in, ``(env,)``.
        rewards, dones, infos
            As Stable-Baselines3's vector environments return them.
        """
        self._buffer.episode_starts[self._step] = episode_starts
        self._buffer.rewards[self._step] = rewards
        for env in np.flatnonzero(dones).tolist():
            last = infos[env].get("terminal_observation")
            if last is not None and infos[env].get("TimeLimit.truncated", False):
                self._cut_short.append((self._step, env))
                self._last_observations.append(last)
        self._step += 1
        self._buffer.pos = self._step
        self._buffer.full = self._step == self._buffer.buffer_size

    def finish(self, observations: np.ndarray, dones: np.ndarray) -> None:
        """Complete the buffer with densities, values, advantages and returns.

        An episode that was cut short is credited with the value of what it did not live to see.

        Parameters
        ----------
        observations, dones
            Of the last step, ``(env, observation)`` and ``(env,)``.

        Raises
        ------
        LearningError
            If an observation or a reward is not finite.
        """
        buffer = self._buffer
        if not (np.isfinite(buffer.observations).all() and np.isfinite(buffer.rewards).all()):
            raise LearningError(
                "An environment returned an observation or a reward that is not finite.",
                remedy="Let it end the episode before its state is no longer finite.",
            )
        density = log_densities_of_noise if self._config.clip_per_action else log_density_of_noise
        buffer.log_probs = density(self._noise, self._log_std).numpy()
        buffer.values[:] = self._value(buffer.observations).reshape(buffer.values.shape)
        if self._cut_short:
            bootstrap = buffer.gamma * self._value(np.stack(self._last_observations))
            steps, envs = np.array(self._cut_short).T
            buffer.rewards[steps, envs] += bootstrap
        last_values = self._value(observations)
        if self._config.time_horizon is None:
            buffer.compute_returns_and_advantage(torch.from_numpy(last_values), dones)
            return
        buffer.advantages = cut_advantages(
            buffer.rewards,
            buffer.values,
            buffer.episode_starts.astype(np.bool_),
            last_values,
            dones,
            discount=buffer.gamma,
            gae_lambda=buffer.gae_lambda,
            horizon=self._config.time_horizon,
        )
        buffer.returns = buffer.advantages + buffer.values

    def _value(self, observations: np.ndarray) -> np.ndarray:
        """Return the values of observations, shape ``(row,)``."""
        rows = torch.from_numpy(observations).float().reshape(-1, self._inputs.shape[1])
        parts = [self._critic(part.clone()) for part in rows.split(VALUED_AT_ONCE)]
        return torch.cat(parts).flatten().numpy()
