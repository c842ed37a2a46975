"""Levels at a matched budget: cut off, or gone on with, until the steps are used up."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from surmount.core.arrays import FloatArray
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.state import belongs_to, require_same
from surmount.teachers.teacher import LevelTest, RolloutOutcome, TeacherStatus

_NAME = "levels at a budget"


class BudgetedLevels:
    """A level teacher that trains exactly as long as the others it is compared with.

    Where its levels are over earlier it stays at the last one; where the steps are used up
    earlier it ends in the middle of a level.

    Parameters
    ----------
    levels
        The level teacher.
    total_steps
        Learning steps to train, over all environments.
    """

    def __init__(self, levels: LevelTeacher, total_steps: int) -> None:
        self._levels = levels
        self._total_steps = total_steps
        self._steps = 0

    @property
    def finished(self) -> bool:
        """Whether the steps are used up."""
        return self._steps >= self._total_steps

    def status(self) -> TeacherStatus:
        """Say at which level the teacher stands."""
        status = self._levels.status()
        return TeacherStatus(
            label="after the last level" if self._levels.finished else status.label,
            steps=self._steps,
            planned_steps=self._total_steps,
            level=status.level or self._levels.n_levels,
        )

    def distribution(self) -> TaskDistribution:
        """Return the level's distribution; after the last level, still the last."""
        return self._levels.distribution()

    def sample(self, k: int = 1) -> FloatArray:
        """Draw tasks of the level, shape ``(k, parameter)``."""
        return self._levels.sample(k)

    def update_on_episode(
        self,
        episode_return: float,
        length: int,
        task: FloatArray,
        progress: float,
        env_id: int | None = None,
        *,
        value_error: float | None = None,
    ) -> None:
        """Count the decisions, and hand the episode on."""
        self._steps += length
        self._levels.update_on_episode(
            episode_return, length, task, progress, env_id, value_error=value_error
        )

    def update_on_rollout(self, outcome: RolloutOutcome) -> LevelTest | None:
        """Count the steps, and hand the roll-out on."""
        self._steps += outcome.rewards.size
        return self._levels.update_on_rollout(outcome)

    def state_dict(self) -> dict[str, Any]:
        """Return the steps done and the state of the levels."""
        return {
            **belongs_to(_NAME, None),
            "steps": self._steps,
            "levels": self._levels.state_dict(),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        require_same(state, _NAME, None)
        self._steps = int(state["steps"])
        self._levels.load_state_dict(state["levels"])
