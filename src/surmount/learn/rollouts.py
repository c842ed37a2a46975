"""Roll-outs: a trained network acts on every variant, and its behaviour is logged (II-A)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.policies import ActorCriticPolicy

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.errors import ConfigError, InputError
from surmount.envs.vector_env import TaskVectorEnv, task_axes
from surmount.learn.learner import Acts, TrialActor
from surmount.learn.mlp import ACTIVATIONS
from surmount.learn.noise import CorrelatedNoise
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.snapshot import (
    Snapshot,
    action_divisor,
    check_architecture,
    missing_weights,
    noise_correlation,
    policy_weights,
)
from surmount.trials.trials import Trials
from surmount.workflow.monitor import Interrupted, Monitor, Progress

CLIP_OBSERVATION = 10.0
"""Standardised observations are clipped as in training (Stable-Baselines3's default)."""
EPSILON = 1e-8
"""Added to the variance when standardising, as in training (Stable-Baselines3's default)."""


class Actor:
    """A network of Surmount's own PPO that acts: observations in, Gaussian actions out.

    Satisfies :class:`surmount.learn.learner.TrialActor`.

    Parameters
    ----------
    network
        Snapshot of a trained network.
    observation_space, action_space
        Spaces of a single environment.

    Attributes
    ----------
    noise_correlation
        Correlation from step to step of the noise that the network learnt with.
    """

    def __init__(
        self,
        network: Snapshot,
        observation_space: gymnasium.Space[Any],
        action_space: gymnasium.Space[Any],
    ) -> None:
        record = network.record
        check_architecture(network)
        if not isinstance(action_space, gymnasium.spaces.Box):
            raise InputError(
                f"The network gives numbers, and actions are {action_space}.",
                remedy="Use it with the task that it was trained on.",
            )
        self.noise_correlation = noise_correlation(network)
        self._divisor = action_divisor(network)
        self._policy = ActorCriticPolicy(
            observation_space,
            action_space,
            lambda _: 0.0,
            net_arch=list(record["hidden_layers"]),
            activation_fn=ACTIVATIONS[record["activation"]].module,
        )
        try:
            if missing := missing_weights(self._policy, network.tensors):
                raise RuntimeError(f"it has no {missing[0]}")  # noqa: TRY301 - one sentence for all
            # A network that is there to act may come without its critic.
            self._policy.load_state_dict(policy_weights(network.tensors), strict=False)
        except RuntimeError as error:
            raise InputError(
                f"The network does not fit the environment ({error}).",
                remedy="Use it with the task and configuration it was trained on.",
            ) from error
        self._policy.set_training_mode(False)
        self._space = action_space
        self._statistics: Mapping[str, np.ndarray] | None = None
        if record["normalise_observations"]:
            self._statistics = network.tensors

    def act(self, observations: FloatArray, noise: FloatArray | None) -> FloatArray:
        """Return actions, divided as the network learnt it and clipped to the action space.

        Parameters
        ----------
        observations
            Shape ``(env, observation)``.
        noise
            Standard normal numbers, shape ``(env, action)``, scaled by the policy's standard
            deviation; ``None`` for the policy's mean.
        """
        with torch.no_grad():
            inputs = torch.from_numpy(self._standardise(observations))
            distribution: Any = self._policy.get_distribution(inputs).distribution
            actions = distribution.mean.numpy()
            if noise is not None:
                actions = actions + distribution.stddev.numpy() * noise
        return np.clip(actions / self._divisor, self._space.low, self._space.high)

    def begin(self, trials: int, rng: np.random.Generator, *, deterministic: bool) -> Acts:
        """Begin so many trials at once, with noise correlated over time if it was in training."""
        correlated = CorrelatedNoise(self.noise_correlation)
        shape = (trials, *self._space.shape)

        def act(observations: Any) -> np.ndarray:
            # Noise is drawn for ended trials too: a trial's numbers do not depend on others.
            fresh = None if deterministic else rng.standard_normal(shape)
            return self.act(observations, None if fresh is None else correlated.next(fresh))

        return act

    def _standardise(self, observations: FloatArray) -> np.ndarray:
        if self._statistics is None:
            return observations.astype(np.float32)
        mean = self._statistics["normaliser/observation/mean"]
        variance = self._statistics["normaliser/observation/var"]
        scaled = (observations - mean) / np.sqrt(variance + EPSILON)
        return np.clip(scaled, -CLIP_OBSERVATION, CLIP_OBSERVATION).astype(np.float32)


def roll_out(
    env: TaskVectorEnv,
    actor: TrialActor,
    variants: FloatArray,
    config: RolloutConfig,
    *,
    network: int,
    seed: int,
    monitor: Monitor,
) -> Trials:
    """Run every trial of one network at once and log its features at every control step.

    The policy draws its actions as it did when it learned.

    Parameters
    ----------
    env
        Environments without automatic reset, one per trial: ``variants x repetitions``. A trial
        that has ended is not simulated any further.
    actor
        The network that acts.
    variants
        Tasks in the parameters' units, shape ``(variant, parameter)``.
    config
        Repetitions and kind of action.
    network
        Index of the network, kept in the trials.
    seed
        Seed of environments and actions.
    monitor
        Shown the number of trials ended and of steps taken.

    Raises
    ------
    Interrupted
        If the monitor asked to stop; roll-outs are repeated from their start.
    """
    variant = np.repeat(variants, config.repetitions, axis=0)
    trials = variant.shape[0]
    if env.num_envs != trials:
        raise ConfigError(
            f"{trials} trials need as many environments, not {env.num_envs}.",
            remedy="Build the environments for variants x repetitions.",
        )
    rng = np.random.default_rng(seed)
    act = actor.begin(trials, rng, deterministic=config.deterministic)
    observations, infos = env.reset(seed=seed, options={"variant": variant})
    active = np.ones(trials, dtype=np.bool_)
    success = np.zeros(trials, dtype=np.bool_)
    rows: list[FloatArray] = [infos["features"].copy()]
    owners: list[IntArray] = [np.arange(trials)]
    steps = 0
    while active.any():
        if monitor.should_stop():
            raise Interrupted
        observations, _, terminated, truncated, infos = env.step(act(observations))
        owner = np.flatnonzero(active)
        owners.append(owner)
        rows.append(infos["features"][owner].copy())
        done: BoolArray = active & (terminated | truncated)
        success[done] = infos["is_success"][done]
        active &= ~done
        steps += owner.size
        label = f"{trials - int(active.sum())} of {trials} trials ended"
        monitor.progress(Progress(label=label, done=steps, planned=None, unit="steps"))
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return Trials(
        parameters=tuple(env.task_parameters),
        feature_names=tuple(env.feature_names),
        variant=variant,
        network=np.full(trials, network, dtype=np.int64),
        repetition=np.tile(np.arange(config.repetitions), len(variants)),
        success=success,
        starts=np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=trials))]),
        features=np.concatenate(rows)[order],
        axes=task_axes(env),
    )
