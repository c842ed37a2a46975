"""Which learner a configuration asks for, and which actor a network's record tells."""

from __future__ import annotations

from typing import Any

import gymnasium

from surmount.learn.algorithm_names import OFF_POLICY
from surmount.learn.config import AUTO, OWN, LearnerConfig
from surmount.learn.learner import Learner, TrialActor
from surmount.learn.own_learner import OwnLearner, fits_own
from surmount.learn.recorder import Recorder
from surmount.learn.rollouts import Actor
from surmount.learn.snapshot import Snapshot
from surmount.learn.stable_actor import StableActor
from surmount.learn.stable_config import ALGORITHM, StableConfig
from surmount.learn.stable_learner import StableLearner


def make_learner(env: Recorder, config: LearnerConfig, *, seed: int) -> Learner:
    """Return the learner of a configuration, on environments.

    Raises
    ------
    ConfigError
        If there is no such algorithm, or it does not fit the environments.
    """
    if config.algorithm == OWN or (
        config.algorithm == AUTO and fits_own(env.observation_space, env.action_space)
    ):
        return OwnLearner(env, config, seed=seed)
    chosen = (
        StableConfig.like_own(config, env.env.step_s, env.observation_space)
        if config.algorithm == AUTO
        else StableConfig.named(config)
    )
    return StableLearner(
        env,
        chosen,
        rollout_steps=config.rollout_steps,
        decay_steps=config.decay_steps,
        seed=seed,
    )


def make_actor(
    network: Snapshot,
    observation_space: gymnasium.Space[Any],
    action_space: gymnasium.Space[Any],
) -> TrialActor:
    """Return what acts in trials of a network.

    Raises
    ------
    InputError
        If the network does not fit the spaces, or its record is not one.
    """
    if ALGORITHM in network.record:
        return StableActor(network, observation_space, action_space)
    return Actor(network, observation_space, action_space)  # refuses what is no box


def estimates_values(config: LearnerConfig) -> bool | None:
    """Whether the learner of a configuration estimates values; ``None`` where only it can tell."""
    if config.uses_own_fields:
        return True
    return None if ":" in config.algorithm else config.algorithm not in OFF_POLICY
