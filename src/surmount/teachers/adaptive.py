"""What teachers share whose distribution follows from the episodes that ended."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

from surmount.core.arrays import FloatArray, IntArray
from surmount.teachers.base import BudgetTeacher, EndedEpisode
from surmount.teachers.draws import Draws


class AdaptiveTeacher(BudgetTeacher):
    """A teacher for a fixed number of steps whose distribution depends on episodes alone.

    Environments draw from the distribution inside ``reset`` until the next one is pushed, after
    each roll-out. The distribution is a function of the seed and of the saved state, so asking for
    it twice, or after resuming, gives the same (docs/adr/0070).

    Parameters
    ----------
    label
        Name for displays.
    tasks
        What it chooses among, as JSON values: saved progress belongs to them.
    total_steps
        Learning steps to train, over all environments.
    seed
        Of everything random in the teacher.
    """

    def __init__(self, *, label: str, tasks: Any, total_steps: int, seed: int) -> None:
        super().__init__(
            label=label, total_steps=total_steps, name=label, tasks=tasks, draws=Draws(seed)
        )
        self._seed = seed
        self._ends_at = 0
        """Learning steps at the end of the episode that :meth:`take` is told of."""

    def take_steps(
        self, rewards: FloatArray, ends: IntArray, episodes: Sequence[EndedEpisode]
    ) -> None:
        """Take the episodes in the order in which they ended, and count the steps."""
        for end, episode in zip(ends, episodes, strict=True):
            self._ends_at = self._steps + int(end)
            self.take(episode)
        self._steps += rewards.size

    @abstractmethod
    def take(self, episode: EndedEpisode) -> None:
        """Learn from one episode that ended."""
