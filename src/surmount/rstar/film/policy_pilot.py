"""A trained network as a pilot, acting as it does in roll-outs."""

from __future__ import annotations

from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.learn.noise import CorrelatedNoise
from surmount.learn.rollouts import Actor
from surmount.learn.snapshot import Snapshot
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.observations import Observations, observation_terms
from surmount.rstar.course.obstacles import Obstacle

INPUT_LAYER = "policy/mlp_extractor.policy_net.0.weight"
"""Weights of a network's first layer, shape ``(unit, observation)``."""


class PolicyPilot:
    """Acts as trial ``trial`` of ``trials`` that are rolled out at once with a seed.

    Sums in matrix products depend on their shape in the last bits, and noise is drawn for all
    trials together: alone, the trial is given the row it had among the others. So it is the same
    trial to the last bit, and takes none of the others' physics.

    Parameters
    ----------
    network
        The network.
    obstacle, config
        Family and configuration that it acts on.
    seed
        Seed of the roll-out.
    deterministic
        Whether to act by the mean of the policy.
    trials, trial
        Number of trials rolled out at once, and the one that is acted for.

    Raises
    ------
    InputError
        If the network does not fit the obstacle's observations.
    """

    def __init__(
        self,
        network: Snapshot,
        obstacle: Obstacle,
        config: EnvConfig,
        *,
        seed: int,
        deterministic: bool,
        trials: int = 1,
        trial: int = 0,
    ) -> None:
        inputs = network.tensors[INPUT_LAYER].shape[1] if INPUT_LAYER in network.tensors else None
        terms = observation_terms(obstacle, targets=config.observe_targets)
        if inputs != len(terms):
            raise InputError(
                f"The network takes {inputs} observations, and {obstacle.name} has {len(terms)}.",
                remedy="Name the obstacle, and the `env.observe_targets`, that it was trained on.",
            )
        env = ObstacleVectorEnv(obstacle.name, 1, config=config)
        actions: Any = env.single_action_space
        self._actor = Actor(network, env.single_observation_space, actions)
        self._rng = None if deterministic else np.random.default_rng(seed)
        self._correlated = CorrelatedNoise(self._actor.noise_correlation)
        self._trial = trial
        self._rows: FloatArray = np.zeros((trials, len(terms)))
        self._noise_shape = (trials, *(env.single_action_space.shape or ()))

    def __call__(self, observations: Observations, x_m: FloatArray) -> FloatArray:
        """Return the actions of this step, shape ``(1, 3)``."""
        del x_m
        noise = None
        if self._rng is not None:
            noise = self._correlated.next(self._rng.standard_normal(self._noise_shape))
        self._rows[self._trial] = observations[0]
        return self._actor.act(self._rows, noise)[self._trial : self._trial + 1]
