"""Any algorithm of Stable-Baselines3's kind behind the seam of learners."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from stable_baselines3 import HerReplayBuffer
from stable_baselines3.common.buffers import ReplayBuffer, RolloutBuffer
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.utils import set_random_seed
from stable_baselines3.common.vec_env import (
    VecCheckNan,
    VecEnv,
    VecExtractDictObs,
    VecFrameStack,
    VecMonitor,
    VecNormalize,
    VecTransposeImage,
)

from surmount.core.errors import ConfigError, LearningError, cause
from surmount.learn.algorithm_names import is_function
from surmount.learn.algorithms import build_model
from surmount.learn.experience import keeps_infos, put_experience, take_experience
from surmount.learn.faults import is_sound_policy
from surmount.learn.model_state import (
    load_loop_state,
    loop_state,
    put_model,
    take_model,
    wrappers,
)
from surmount.learn.recorder import Recorder
from surmount.learn.snapshot import Tensors
from surmount.learn.stable_config import ALGORITHM, StableConfig

RESTORED = (VecNormalize, VecFrameStack, VecTransposeImage, VecMonitor, VecCheckNan,
            VecExtractDictObs)  # fmt: skip
"""Wrappers without state, or whose state is kept."""


class StableLearner:
    """Satisfies :class:`surmount.learn.learner.Learner`.

    ``learn`` of the model is called for a roll-out at a time, and goes on where it was. Schedules
    run over ``decay_steps`` of each training; without, none may fall. Exploration of DQN's kind
    falls once, over the first training.

    Parameters
    ----------
    env
        Environments to learn in.
    config
        What the model is made from.
    rollout_steps
        Steps of each environment between updates of the teacher, for algorithms without roll-outs.
    decay_steps
        Learning steps over which schedules run.
    seed
        Of weights, exploration, batches and environments.

    Raises
    ------
    ConfigError
        If the algorithm, its arguments and the environments do not fit.
    """

    def __init__(
        self,
        env: Recorder,
        config: StableConfig,
        *,
        rollout_steps: int,
        decay_steps: int | None,
        seed: int,
    ) -> None:
        self._config = config
        self._decay_steps = decay_steps
        self._seed = seed
        self.model: Any = build_model(
            config.algorithm, config.arguments, wrapped(env, config), seed=seed
        )
        if is_function(config.algorithm):
            self.model.set_random_seed(seed)
        self._per_learn = getattr(self.model, "n_steps", rollout_steps) * env.num_envs
        self.estimates_values = isinstance(
            getattr(self.model, "rollout_buffer", None), RolloutBuffer
        )
        if not self.estimates_values:
            self._per_learn = rollout_steps * env.num_envs
        self._require_a_horizon()
        self.notes = tuple(self._remarks())

    @property
    def policy(self) -> torch.nn.Module:
        """What acts."""
        return self.model.policy

    @property
    def logger(self) -> Logger:
        """Where learning writes its figures."""
        return self.model.logger

    def begin(self, start: Mapping[str, np.ndarray] | None, *, planned_steps: int | None) -> None:
        """Begin anew, or from a snapshot; exploration that has fallen stays where it is."""
        horizon = self._decay_steps or planned_steps
        if start is not None:
            put_model(start, self.model)
            set_random_seed(self._seed)
            if hasattr(self.model, "exploration_final_eps"):
                final: float = self.model.exploration_final_eps
                self.model.exploration_schedule = lambda _: final
                self.model.exploration_rate = final

        def remain(num_timesteps: int, total_timesteps: int) -> None:
            del total_timesteps  # of a roll-out: `learn` knows of no more
            left = 1.0 if not horizon else max(0.0, 1.0 - num_timesteps / horizon)
            self.model._current_progress_remaining = left  # noqa: SLF001

        self.model._update_current_progress_remaining = remain  # noqa: SLF001

    def learn_one_rollout(self) -> int:
        """Learn for about a roll-out; no update is left out.

        Raises
        ------
        LearningError
            If the algorithm fails.
        """
        try:
            self.model.learn(
                self._per_learn,
                reset_num_timesteps=False,
                log_interval=1 if self.estimates_values else None,
            )
        except (ValueError, AssertionError, RuntimeError) as error:
            raise LearningError(
                f"{self._config.algorithm} failed after {self.model.num_timesteps:,} steps "
                f"({cause(error)}).",
                remedy="Lower its learning rate, normalise rewards and observations "
                "(`learner.vec_normalize`), or let `surmount check` look at the environment.",
            ) from error
        return 0

    @property
    def is_sound(self) -> bool:
        """Whether all weights are finite."""
        return is_sound_policy(self.policy)

    def advantages(self) -> np.ndarray | None:
        """Return those of the newest roll-out, ``(step, env)``."""
        if not self.estimates_values:
            return None
        buffer: RolloutBuffer = self.model.rollout_buffer
        advantages = np.asarray(buffer.advantages)
        if advantages.shape == (buffer.buffer_size, buffer.n_envs):
            return advantages
        # Once batches were taken, rows are those of one environment after the other.
        return advantages.reshape(buffer.n_envs, buffer.buffer_size).T

    def take(self) -> Tensors:
        """Return copies of weights, optimisers and running statistics."""
        return take_model(self.model)

    def put(self, tensors: Mapping[str, np.ndarray]) -> None:
        """Take up what :meth:`take` returned."""
        put_model(tensors, self.model)

    def memory(self) -> Tensors:
        """Return the replay buffer, where there is one."""
        buffer = getattr(self.model, "replay_buffer", None)
        return take_experience(buffer) if isinstance(buffer, ReplayBuffer) else {}

    def remember(self, memory: Mapping[str, np.ndarray], *, goes_on: bool) -> None:
        """Take up a replay buffer; in a new training episodes end there, and no warm-up follows."""
        if not memory:
            return
        buffer = self.model.replay_buffer
        put_experience(memory, buffer)
        if goes_on:
            return
        self.model.learning_starts = 0
        if isinstance(buffer, HerReplayBuffer):
            with warnings.catch_warnings():  # that it does what it is asked to
                warnings.simplefilter("ignore", UserWarning)
                buffer.truncate_last_trajectory()

    def record(self) -> dict[str, Any]:
        """Return what the model was made from."""
        return {ALGORITHM: self._config.to_record()}

    @property
    def has_begun(self) -> bool:
        """Whether environments were stepped."""
        return self.model._last_obs is not None  # noqa: SLF001

    def loop_state(self) -> dict[str, Any]:
        """Return where the loop stands."""
        return loop_state(self.model) | {"learning_starts": getattr(
            self.model, "learning_starts", 0)}  # fmt: skip

    def load_loop_state(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved loop state."""
        if hasattr(self.model, "learning_starts"):
            self.model.learning_starts = state["learning_starts"]
        load_loop_state(self.model, state)

    def _require_a_horizon(self) -> None:
        falling = [
            name
            for name in ("lr_schedule", "clip_range", "clip_range_vf")
            if callable(schedule := getattr(self.model, name, None))
            and schedule(1.0) != schedule(0.5)
        ]
        if falling and self._decay_steps is None:
            raise ConfigError(
                f"The schedule of `{falling[0]}` falls, and nobody said over how many steps: the "
                "length of a curriculum is not known beforehand.",
                remedy="Give `learner.decay_steps`, counted from the beginning of each training.",
            )

    def _remarks(self) -> list[str]:
        remarks: list[str] = []
        if self.model.device.type != "cpu":
            remarks.append(
                f"On {self.model.device} results do not repeat bit for bit, not even without an "
                "interruption."
            )
        unknown = [type(one).__name__ for one in wrappers(self.model)
                   if not isinstance(one, RESTORED)]  # fmt: skip
        if unknown:
            remarks.append(
                f"What {', '.join(unknown)} keeps is not saved: training that goes on after an "
                "interruption begins it anew."
            )
        if keeps_infos(getattr(self.model, "replay_buffer", None) or self):  # type: ignore[arg-type]
            remarks.append(
                "Infos copied into the replay buffer are not saved: after an interruption those "
                "of before are empty."
            )
        return remarks


def wrapped(env: VecEnv, config: StableConfig) -> VecEnv:
    """Return environments with the wrappers of a configuration: stacked first, then normalised.

    Raises
    ------
    ConfigError
        If they do not take such observations, or such arguments.
    """
    try:
        if config.frame_stack > 1:
            env = VecFrameStack(env, config.frame_stack)
        if config.vec_normalize is not None:
            env = VecNormalize(env, **config.vec_normalize)
    except Exception as error:  # its assertions, and what they are called with
        raise ConfigError(
            f"`learner.frame_stack` or `learner.vec_normalize` cannot be used here "
            f"({cause(error)}).",
            remedy="Leave it out, or change its arguments; observations are "
            f"{env.observation_space}.",
        ) from error
    return env
