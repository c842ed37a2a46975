"""What happened during training: one row per roll-out and one per episode."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.learn.episode_recorder import COLUMNS, episodes_of
from surmount.teachers.teacher import Episodes, RolloutOutcome


class History:
    """Grows by one roll-out at a time and can be saved and loaded in between.

    Attributes
    ----------
    steps
        Learning steps at the end of each roll-out, ``(rollout,)``.
    reward
        Mean unnormalised reward per learning step, ``(rollout,)``.
    success
        Share of successful episodes among those that ended, NaN where none did, ``(rollout,)``.
    label
        The teacher's status after each roll-out.
    episodes
        All episodes that ended, without the share of the way that they covered.
    """

    def __init__(self, *, parameters: Sequence[str]) -> None:
        self.parameters = tuple(parameters)
        self.steps: IntArray = np.empty(0, dtype=np.int64)
        self.reward: FloatArray = np.empty(0)
        self.success: FloatArray = np.empty(0)
        self.label: list[str] = []
        self.episodes = episodes_of([], len(self.parameters))

    def add(self, outcome: RolloutOutcome, *, label: str) -> None:
        """Append what one roll-out brought."""
        done = int(self.steps[-1]) if self.steps.size else 0
        self.steps = np.append(self.steps, done + outcome.rewards.size)
        self.reward = np.append(self.reward, outcome.rewards.mean())
        self.success = np.append(self.success, _mean(outcome.episodes.success))
        self.label.append(label)
        self.episodes = Episodes(
            **{
                name: np.concatenate(
                    [getattr(self.episodes, name), getattr(outcome.episodes, name)]
                )
                for name in COLUMNS
            }
        )

    def latest(self) -> dict[str, float]:
        """Return the newest figures for a progress display."""
        values = {"reward": float(self.reward[-1])}
        if np.isfinite(self.success[-1]):
            values["success"] = float(self.success[-1])
        return values

    def state_dict(self) -> dict[str, Any]:
        """Return everything as arrays and JSON values."""
        return {
            "steps": self.steps,
            "reward": self.reward,
            "success": self.success,
            "label": list(self.label),
            "episodes": {name: getattr(self.episodes, name) for name in COLUMNS},
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        self.steps = state["steps"]
        self.reward = state["reward"]
        self.success = state["success"]
        self.label = list(state["label"])
        self.episodes = Episodes(**state["episodes"])


def _mean(values: BoolArray) -> float:
    return float(values.mean()) if values.size else float("nan")
