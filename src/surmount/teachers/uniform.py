"""The teacher without a curriculum: one fixed distribution for a fixed number of steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from surmount.core.arrays import FloatArray, IntArray
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.base import BudgetTeacher, EndedEpisode
from surmount.teachers.draws import Draws


class UniformTeacher(BudgetTeacher):
    """Initiation and the paper's control: uniform variants throughout (III-C).

    Parameters
    ----------
    distribution
        What environments draw from, usually uniform over the whole range of the task parameters.
    total_steps
        Learning steps to train, over all environments. Training ends with the first roll-out
        that reaches it.
    label
        Name for displays.
    seed
        Of :meth:`sample`.
    """

    def __init__(
        self,
        distribution: TaskDistribution,
        total_steps: int,
        *,
        label: str = "uniform",
        seed: int = 0,
    ) -> None:
        super().__init__(
            label=label,
            total_steps=total_steps,
            name="one distribution",
            tasks=distribution.to_record(),
            draws=Draws(seed),
        )
        self._distribution = distribution

    def distribution(self) -> TaskDistribution:
        """Return the fixed distribution."""
        return self._distribution

    def take_steps(
        self, rewards: FloatArray, ends: IntArray, episodes: Sequence[EndedEpisode]
    ) -> None:
        """Count the steps."""
        self._steps += rewards.size

    def _state(self) -> dict[str, Any]:
        return {}

    def _load(self, state: Mapping[str, Any]) -> None:
        pass
