"""The record of a roll-out under way: its rewards, and the episodes that ended in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.learn.value_errors import EpisodeErrors
from surmount.teachers.teacher import Episodes, RolloutOutcome

COLUMNS: dict[str, Any] = {
    "step": np.int64,
    "variant": np.float64,
    "reward": np.float64,
    "length": np.int64,
    "success": np.bool_,
    "diverged": np.bool_,
}
"""Columns of :class:`surmount.teachers.teacher.Episodes` that are always there, and their types."""


class EpisodeRecorder:
    """Adds up the episodes of environments that learn at once, for what teachers are told.

    Parameters
    ----------
    num_envs
        Environments that learn at once.
    parameters
        Number of task parameters.
    steps
        Learning steps done before.

    Attributes
    ----------
    steps
        Learning steps so far, over all environments.
    """

    def __init__(self, num_envs: int, parameters: int, *, steps: int = 0) -> None:
        self.steps = steps
        self._parameters = parameters
        self._reward: FloatArray = np.zeros(num_envs)
        self._length = np.zeros(num_envs, dtype=np.int64)
        self._errors = EpisodeErrors(num_envs)
        self._forget()

    @property
    def recorded_steps(self) -> int:
        """Learning steps since :meth:`collect` was last called."""
        return len(self._rewards) * self._reward.size

    def begin_all(self) -> None:
        """Begin an episode in every environment; those under way count no more."""
        self._reward[:] = 0.0
        self._length[:] = 0

    def add(self, rewards: np.ndarray) -> None:
        """Take the unnormalised rewards of one step in every environment, ``(env,)``."""
        self.steps += self._reward.size
        self._rewards.append(np.array(rewards, dtype=np.float64))
        self._reward += rewards
        self._length += 1

    def end(
        self,
        env: int,
        *,
        variant: Any,
        success: bool,
        diverged: bool,
        covered: float | None = None,
    ) -> dict[str, Any]:
        """End an episode with the step last added, and return it as a row of `Episodes`.

        Parameters
        ----------
        env
            Its environment, where the next one begins.
        variant
            Its task in the parameters' units, ``(parameter,)``.
        success, diverged
            Whether it reached its goal, and whether the physics diverged.
        covered
            Share of the way to its goal that it covered, where the environment tells.
        """
        episode = {
            "step": self.steps,
            "variant": np.array(variant, dtype=np.float64).reshape(-1),
            "reward": float(self._reward[env]),
            "length": int(self._length[env]),
            "success": success,
            "diverged": diverged,
            "covered": covered,
        }
        self._ends.append((len(self._rewards) - 1, env))
        self._episodes.append(episode)
        self._reward[env] = 0.0
        self._length[env] = 0
        return episode

    def collect(self, advantages: np.ndarray | None = None) -> RolloutOutcome:
        """Return what was recorded since the last call, and forget it.

        Parameters
        ----------
        advantages
            Of all steps since then, ``(step, env)``, where the learner has them.
        """
        outcome = RolloutOutcome(
            rewards=np.concatenate(self._rewards) if self._rewards else np.empty(0),
            episodes=episodes_of(self._episodes, self._parameters),
            value_errors=None if advantages is None else self._errors.add(advantages, self._ends),
            steps_before=self.steps - self.recorded_steps,
        )
        self._forget()
        return outcome

    def state_dict(self) -> dict[str, Any]:
        """Return the steps done and the running sums of unfinished episodes."""
        return {
            "steps": self.steps,
            "episode_reward": self._reward.copy(),
            "episode_length": self._length.copy(),
            "errors": self._errors.state_dict(),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        self.steps = int(state["steps"])
        self._reward = np.array(state["episode_reward"], dtype=np.float64)
        self._length = np.array(state["episode_length"], dtype=np.int64)
        self._errors.load_state_dict(state["errors"])

    def _forget(self) -> None:
        self._rewards: list[FloatArray] = []
        self._ends: list[tuple[int, int]] = []
        self._episodes: list[dict[str, Any]] = []


def episodes_of(rows: Sequence[Mapping[str, Any]], parameters: int) -> Episodes:
    """Return the columns of episodes over so many task parameters."""
    columns: dict[str, Any] = {
        name: np.array([row[name] for row in rows], kind) for name, kind in COLUMNS.items()
    }
    columns["variant"] = columns["variant"].reshape(len(rows), parameters)
    covered = [row.get("covered") for row in rows]
    if rows and None not in covered:
        columns["covered"] = np.array(covered, dtype=np.float64)
    return Episodes(**columns)
