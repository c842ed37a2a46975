"""The seam between learning under a teacher and whoever learns: Surmount's PPO, or anybody's.

Training (:mod:`surmount.learn.trainer`) knows learners by :class:`Learner` alone, trials
(:mod:`surmount.learn.rollouts`) know what acts in them by :class:`TrialActor` alone;
:mod:`surmount.learn.choice` gives both by the configuration or by a network's record.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import torch
from stable_baselines3.common.logger import Logger

from surmount.learn.snapshot import Tensors


class Learner(Protocol):
    """Learns from the environments that it was made with, a roll-out's worth at a time.

    Attributes
    ----------
    model
        What Stable-Baselines3 calls an algorithm.
    notes
        What resuming cannot repeat exactly, and what else a user should know; told once.
    estimates_values
        Whether a critic estimates advantages, which some teachers need.
    """

    model: Any
    notes: tuple[str, ...]
    estimates_values: bool

    @property
    def policy(self) -> torch.nn.Module:
        """What acts, with all its weights."""
        ...

    @property
    def logger(self) -> Logger:
        """Where learning writes its figures."""
        ...

    def begin(self, start: Mapping[str, np.ndarray] | None, *, planned_steps: int | None) -> None:
        """Begin anew, or from a snapshot's weights, optimisers and statistics.

        Parameters
        ----------
        start
            Tensors of a snapshot; ``None`` to begin anew.
        planned_steps
            Learning steps that the teacher expects this training to take, where it knows.
        """
        ...

    def learn_one_rollout(self) -> int:
        """Collect about a roll-out and learn from it; return the updates that were left out."""
        ...

    @property
    def is_sound(self) -> bool:
        """Whether the newest roll-out left weights that can go on learning."""
        ...

    def advantages(self) -> np.ndarray | None:
        """Return those of the newest roll-out, ``(step, env)``, where a critic estimates them."""
        ...

    def take(self) -> Tensors:
        """Return copies of weights, optimisers and running statistics by name."""
        ...

    def put(self, tensors: Mapping[str, np.ndarray]) -> None:
        """Take up what :meth:`take` returned."""
        ...

    def memory(self) -> Tensors:
        """Return past experience that a next training should go on with; empty where none."""
        ...

    def remember(self, memory: Mapping[str, np.ndarray], *, goes_on: bool) -> None:
        """Take up what :meth:`memory` returned.

        Parameters
        ----------
        memory
            Arrays by name.
        goes_on
            Whether the same training goes on, in the middle of its episodes.
        """
        ...

    def record(self) -> dict[str, Any]:
        """Return, as JSON values, what is needed to build the policy again."""
        ...

    @property
    def has_begun(self) -> bool:
        """Whether there is a loop state to save."""
        ...

    def loop_state(self) -> dict[str, Any]:
        """Return where the loop stands and its random generators, as arrays and JSON values."""
        ...

    def load_loop_state(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved loop state."""
        ...


class Acts(Protocol):
    """Acts in trials that were begun together."""

    def __call__(self, observations: Any) -> np.ndarray:
        """Return the actions of all trials, for their present observations."""
        ...


class TrialActor(Protocol):
    """A trained network that can be tried."""

    def begin(self, trials: int, rng: np.random.Generator, *, deterministic: bool) -> Acts:
        """Begin so many trials at once; what is drawn follows from the generator."""
        ...
