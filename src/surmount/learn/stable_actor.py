"""A policy of Stable-Baselines3's kind that acts in trials, with the state that it needs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.noise import VectorizedActionNoise
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

from surmount.core.errors import InputError
from surmount.learn.algorithm_names import OFF_POLICY, is_function
from surmount.learn.algorithms import build_model
from surmount.learn.fed_env import FedVecEnv
from surmount.learn.learner import Acts
from surmount.learn.model_state import POLICY, put_statistics, wrappers
from surmount.learn.snapshot import Snapshot
from surmount.learn.stable_config import ALGORITHM, StableConfig
from surmount.learn.stable_learner import wrapped


class StableActor:
    """Satisfies :class:`surmount.learn.learner.TrialActor`.

    Actions are drawn as in training: from the policy's distribution, with the exploration that DQN
    ends with, or with the action noise.

    Parameters
    ----------
    network
        Snapshot of a trained network.
    observation_space, action_space
        Spaces of a single environment.

    Raises
    ------
    InputError
        If the network does not fit the spaces.
    """

    def __init__(
        self,
        network: Snapshot,
        observation_space: gymnasium.Space[Any],
        action_space: gymnasium.Space[Any],
    ) -> None:
        config = StableConfig.from_record(network.record.get(ALGORITHM))
        self._network = network
        env = wrapped(FedVecEnv(1, observation_space, action_space), config)
        arguments = dict(config.arguments)
        if not is_function(config.algorithm):
            arguments |= _small(config.algorithm)
        self.model: BaseAlgorithm = build_model(config.algorithm, arguments, env, seed=0)
        self._spaces = observation_space, action_space
        prefix = f"{POLICY}/"
        try:
            self.model.policy.load_state_dict(
                {
                    name.removeprefix(prefix): torch.from_numpy(np.array(value))
                    for name, value in network.tensors.items()
                    if name.startswith(prefix)
                }
            )
            put_statistics(network.tensors, self.model.get_vec_normalize_env())
        except (RuntimeError, KeyError) as error:
            raise InputError(
                f"The network does not fit the environment ({error}).",
                remedy="Use it with the task and configuration it was trained on.",
            ) from error
        self.model.policy.set_training_mode(False)

    def begin(self, trials: int, rng: np.random.Generator, *, deterministic: bool) -> Acts:
        """Begin so many trials at once."""
        fed = FedVecEnv(trials, *self._spaces)
        chain = _rebuilt(fed, self.model)
        model: Any = self.model
        epsilon = 0.0 if deterministic else float(getattr(model, "exploration_final_eps", 0.0))
        noise = None if deterministic else getattr(model, "action_noise", None)
        if noise is not None:
            noise = VectorizedActionNoise(noise, trials)
        set_random_seed(int(rng.integers(2**31)))
        state: Any = None
        starts = np.ones(trials, dtype=np.bool_)
        actions = np.zeros((trials, *(self._spaces[1].shape or ())), self._spaces[1].dtype)
        begun = False

        def act(observations: Any) -> np.ndarray:
            nonlocal state, actions, begun
            fed.observations = observations
            seen = chain.step(actions)[0] if begun else chain.reset()
            actions, state = model.policy.predict(
                seen, state, starts, deterministic=deterministic or epsilon > 0.0
            )
            if epsilon > 0.0:
                draws = rng.random(trials) < epsilon
                for trial in np.flatnonzero(draws):
                    actions[trial] = self._spaces[1].sample()
            elif noise is not None:
                scaled = model.policy.scale_action(actions)
                actions = model.policy.unscale_action(np.clip(scaled + noise(), -1, 1))
            if not begun:
                starts[:], begun = False, True
            return actions

        self._spaces[1].seed(int(rng.integers(2**31)))
        return act


def _small(algorithm: str) -> Mapping[str, Any]:
    """Return arguments with which a model that only acts takes no memory."""
    if algorithm in OFF_POLICY:
        return {"buffer_size": 1}
    return {"n_steps": 2} if algorithm == "A2C" else {"n_steps": 2, "batch_size": 2}


def _rebuilt(fed: FedVecEnv, model: BaseAlgorithm) -> VecEnv:
    """Return the wrappers of a model's environments around others, as they are in use.

    Raises
    ------
    InputError
        If there is one that it is not known how to build.
    """
    env: VecEnv = fed
    for wrapper in wrappers(model):
        if isinstance(wrapper, VecNormalize):
            other = VecNormalize(
                env,
                training=False,
                norm_obs=wrapper.norm_obs,
                norm_reward=False,
                clip_obs=wrapper.clip_obs,
                epsilon=wrapper.epsilon,
                norm_obs_keys=wrapper.norm_obs_keys,
            )
            if wrapper.norm_obs:
                other.obs_rms = wrapper.obs_rms
            env = other
        elif isinstance(wrapper, VecFrameStack):
            env = VecFrameStack(env, wrapper.stacked_obs.n_stack)
        elif isinstance(wrapper, VecTransposeImage):
            env = VecTransposeImage(env)
        elif isinstance(wrapper, VecExtractDictObs):
            env = VecExtractDictObs(env, wrapper.key)
        elif not isinstance(wrapper, VecMonitor | VecCheckNan):
            raise InputError(
                f"A network cannot be tried behind {type(wrapper).__name__}.",
                remedy="Wrap the single environment in `make_env` instead of the vector "
                "environment in `make_model`.",
            )
    return env
