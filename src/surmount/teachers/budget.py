"""Levels at a matched budget: cut off, or gone on with, until the steps are used up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from surmount.core.arrays import FloatArray, IntArray
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.base import BaseTeacher, EndedEpisode
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.teacher import LevelTest, TeacherStatus


class BudgetedLevels(BaseTeacher):
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
        # Tasks drawn by hand are the levels' own: one count of them serves both.
        super().__init__(
            name="levels at a budget",
            tasks=None,
            draws=levels.draws,
        )
        self._levels = levels
        self._total_steps = total_steps

    @property
    def finished(self) -> bool:
        """Whether the steps are used up."""
        return self._steps >= self._total_steps

    def status(self) -> TeacherStatus:
        """Say at which level the teacher stands."""
        status = self._levels.status()
        return replace(
            status,
            label="after the last level" if self._levels.finished else status.label,
            steps=self._steps,
            planned_steps=self._total_steps,
            level=status.level or self._levels.n_levels,
        )

    def distribution(self) -> TaskDistribution:
        """Return the level's distribution; after the last level, still the last."""
        return self._levels.distribution()

    def take_steps(
        self, rewards: FloatArray, ends: IntArray, episodes: Sequence[EndedEpisode]
    ) -> LevelTest | None:
        """Count the steps, and hand them on."""
        self._steps += rewards.size
        return self._levels.take_steps(rewards, ends, episodes)

    def _state(self) -> dict[str, Any]:
        return {"levels": self._levels.state_dict()}

    def _load(self, state: Mapping[str, Any]) -> None:
        self._levels.load_state_dict(state["levels"])
