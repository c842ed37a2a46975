"""Randomisation at work: what was drawn for the present episodes, and where it acts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from mujoco.batch import Batch

from surmount.core.arrays import BoolArray, FloatArray
from surmount.rstar.course.delay import DelayLine
from surmount.rstar.course.dynamics import Dynamics
from surmount.rstar.course.randomisation import FACTORS, RandomisationConfig, draw


class Randomiser:
    """Draws at every reset and at every observation, from each environment's own stream.

    Parameters
    ----------
    config
        What is randomised.
    batch
        Simulations on which the factors act.
    terms
        Names of the observation's entries, in order.
    n_actions
        Number of entries of an action.

    Attributes
    ----------
    factors
        Factors of the present episodes, shape ``(env, factor)``, in the order of
        :data:`~surmount.rstar.course.randomisation.FACTORS`.
    delay
        Actions on their way, or None where none is late.
    noise
        Noise of the present observations in the terms' units, shape ``(term, env)``, or None.
    """

    def __init__(
        self, config: RandomisationConfig, batch: Batch, terms: Sequence[str], n_actions: int
    ) -> None:
        num_envs = batch.nsim
        self._config = config
        self._deviation: FloatArray = np.array([config.deviations.get(term, 0.0) for term in terms])
        self._dynamics = Dynamics(batch) if config.varies_dynamics else None
        self.factors: FloatArray = np.ones((num_envs, len(FACTORS)))
        self.delay: DelayLine | None = None
        if config.delays:
            self.delay = DelayLine(num_envs, n_actions, config.action_delay_steps[1])
        self.noise: FloatArray | None = None
        if config.is_noisy:
            self.noise = np.zeros((len(terms), num_envs))

    def begin(self, env: int, rng: np.random.Generator) -> None:
        """Draw for an episode that begins, and for its first observation."""
        factors, delay = draw(self._config, rng)
        if self._dynamics is not None:
            self.factors[env] = factors
            self._dynamics.put([env], factors[None])
        if self.delay is not None:
            self.delay.begin(env, delay)
        self._sense(env, rng)

    def sense(self, generators: Sequence[np.random.Generator], running: BoolArray | None) -> None:
        """Draw for the next observation of the running environments (None: of all)."""
        if self.noise is not None:
            for env, rng in enumerate(generators):
                if running is None or running[env]:
                    self._sense(env, rng)

    def _sense(self, env: int, rng: np.random.Generator) -> None:
        if self.noise is not None:
            self.noise[:, env] = self._deviation * rng.standard_normal(self._deviation.size)

    def infos(self) -> dict[str, Any]:
        """Return what was drawn for the present episodes, one row per environment."""
        infos: dict[str, Any] = {}
        if self._dynamics is not None:
            infos["dynamics"] = self.factors.copy()
        if self.delay is not None:
            infos["action_delay"] = self.delay.steps.copy()
        return infos

    def state_dict(self) -> dict[str, Any]:
        """Return what was drawn, as arrays."""
        state: dict[str, Any] = {"dynamics": self.factors.copy()}
        if self.delay is not None:
            state["delayed_actions"] = self.delay.waiting.copy()
            state["delay"] = self.delay.steps.copy()
        if self.noise is not None:
            state["noise"] = self.noise.copy()
        return state

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from :meth:`state_dict`."""
        self.factors[:] = state["dynamics"]
        if self._dynamics is not None:
            self._dynamics.put(list(range(len(self.factors))), self.factors)
        if self.delay is not None:
            self.delay.waiting[:] = state["delayed_actions"]
            self.delay.steps[:] = state["delay"]
        if self.noise is not None:
            self.noise[:] = state["noise"]
