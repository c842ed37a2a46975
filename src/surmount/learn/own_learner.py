"""Surmount's own PPO behind the seam of learners."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.utils import set_random_seed

from surmount.core.errors import ConfigError
from surmount.envs.observations import is_image
from surmount.learn import snapshot
from surmount.learn.config import LearnerConfig
from surmount.learn.faults import is_sound_policy
from surmount.learn.normaliser import Normaliser
from surmount.learn.ppo import ResumablePPO
from surmount.learn.recorder import Recorder
from surmount.learn.snapshot import Tensors


def fits_own(observations: gymnasium.Space[Any], actions: gymnasium.Space[Any]) -> bool:
    """Whether the own PPO can learn there: boxes, and no pictures."""
    boxes = isinstance(observations, gymnasium.spaces.Box) and isinstance(
        actions, gymnasium.spaces.Box
    )
    return boxes and not is_image(observations)


class OwnLearner:
    """Satisfies :class:`surmount.learn.learner.Learner`; goes on bit-identically.

    Parameters
    ----------
    env
        Environments to learn in.
    config
        Hyper-parameters.
    seed
        Of weights, exploration, the order of batches and environments.

    Raises
    ------
    ConfigError
        If observations or actions are no boxes, or observations are pictures.
    """

    notes: tuple[str, ...] = ()
    estimates_values = True

    def __init__(self, env: Recorder, config: LearnerConfig, *, seed: int) -> None:
        if not fits_own(env.observation_space, env.action_space):
            raise ConfigError(
                f"The algorithm `ppo` learns with boxes, pictures excepted; observations are "
                f"{env.observation_space}, actions {env.action_space}.",
                remedy='Leave `learner.algorithm` at "auto", or name one such as "PPO".',
            )
        rates = config.at_interval(env.env.step_s)
        self._env = env
        self._config = config
        self._seed = seed
        self._normaliser = Normaliser(
            env,
            observations=config.normalise_observations,
            rewards=config.normalise_rewards,
            discount=rates.discount,
        )
        self.model = ResumablePPO.build(self._normaliser, config, rates, seed)

    @property
    def policy(self) -> torch.nn.Module:
        """What acts."""
        return self.model.policy

    @property
    def logger(self) -> Logger:
        """Where learning writes its figures."""
        return self.model.logger

    def begin(self, start: Mapping[str, np.ndarray] | None, *, planned_steps: int | None) -> None:
        """Begin anew, or from a snapshot."""
        del planned_steps
        if start is not None:
            self.put(start)
            set_random_seed(self._seed)

    def learn_one_rollout(self) -> int:
        """Collect one roll-out and update on it; return the updates that were left out."""
        self.model.learn(self._config.steps_per_rollout, reset_num_timesteps=False, log_interval=1)
        return self.model.skipped_updates

    @property
    def is_sound(self) -> bool:
        """Whether weights are finite, and some update was made."""
        return is_sound_policy(self.policy) and not self.model.all_skipped

    def advantages(self) -> np.ndarray | None:
        """Return those of the newest roll-out, ``(step, env)``."""
        return self.model.rollout_buffer.advantages

    def take(self) -> Tensors:
        """Return copies of weights, optimiser and running statistics."""
        return snapshot.take(self.model, self._normaliser)

    def put(self, tensors: Mapping[str, np.ndarray]) -> None:
        """Take up what :meth:`take` returned."""
        snapshot.put(tensors, self.model, self._normaliser)

    def memory(self) -> Tensors:
        """Return nothing: past roll-outs are never learnt from again."""
        return {}

    def remember(self, memory: Mapping[str, np.ndarray], *, goes_on: bool) -> None:
        """Take up nothing."""

    def record(self) -> dict[str, Any]:
        """Return the network's architecture and how it draws."""
        config = self._config
        record: dict[str, Any] = {
            "hidden_layers": list(config.hidden_layers),
            "activation": config.activation,
            "normalise_observations": config.normalise_observations,
        }
        if config.action_divisor != 1.0:
            record[snapshot.ACTION_DIVISOR] = config.action_divisor
        if config.noise_correlation_s:
            record[snapshot.NOISE] = {
                "correlation_s": config.noise_correlation_s,
                "step_s": self._env.env.step_s,
            }
        return record

    @property
    def has_begun(self) -> bool:
        """Whether a roll-out has been collected."""
        return self.model.has_begun

    def loop_state(self) -> dict[str, Any]:
        """Return where the loop stands."""
        return self.model.loop_state() | {"returns": self._normaliser.returns}

    def load_loop_state(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved loop state."""
        self._normaliser.returns = state["returns"]
        self.model.load_loop_state(state)
