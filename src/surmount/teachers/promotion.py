"""Promote and demote, as robots are moved over rows of terrain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.core.arrays import IntArray
from surmount.core.errors import ConfigError
from surmount.core.seeds import generator
from surmount.tasks.cells import TaskCells
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.adaptive import AdaptiveTeacher
from surmount.teachers.base import EndedEpisode

DEMOTED_BELOW = 0.5
"""Share of the way below which a learner is moved down (Rudin et al. 2021)."""


class PromotionTeacher(AdaptiveTeacher):
    """Moves a population of learners over rows of variants: up on success, down on failure.

    After N. Rudin et al., "Learning to walk in minutes using massively parallel deep reinforcement
    learning" (CoRL 2021): terrain in rows of rising difficulty; a robot that solves its row is
    moved up, one that gets less than half of the way is moved down, one that solves the last row
    starts anew on a random one. Where an episode tells success alone there is nothing between, so
    every failure moves down. All begin on the easiest row. There each robot owns its row. Here
    environments draw from one distribution, so the population is kept as a number of learners per
    row, and a finished episode moves one learner of its row; as all robots share one policy, which
    of them stands where makes no difference.

    Parameters
    ----------
    cells
        Variants to choose among.
    harder
        Direction of difficulty of each parameter, as in :meth:`TaskCells.by_difficulty`.
    learners
        Size of the population: the number of environments.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    """

    def __init__(
        self,
        cells: TaskCells,
        harder: Sequence[int],
        *,
        learners: int,
        total_steps: int,
        seed: int,
    ) -> None:
        super().__init__(
            label="promote and demote",
            tasks=cells.variants.tolist(),
            total_steps=total_steps,
            seed=seed,
        )
        if learners < 1:
            raise ConfigError(f"`learners` is {learners}.", remedy="Give at least 1.")
        self._cells = cells
        self._order = cells.by_difficulty(harder)
        self._rank = np.argsort(self._order)
        self._rows: IntArray = np.zeros(cells.count, dtype=np.int64)
        self._rows[0] = learners
        self._restarts = 0

    def rows(self) -> IntArray:
        """Return the learners on each row, from the easiest, ``(variant,)``."""
        return self._rows.copy()

    def distribution(self) -> TaskDistribution:
        """Return shares in proportion to the learners on each row."""
        weights = np.zeros(self._cells.count)
        weights[self._order] = self._rows
        return self._cells.distribution(weights)

    def take(self, episode: EndedEpisode) -> None:
        """Move one learner of the episode's row, if one still stands there."""
        row = int(self._rank[self._cells.locate(episode.task)])
        if self._rows[row] == 0 or DEMOTED_BELOW <= episode.progress < 1.0:
            return  # drawn before the last of them left, or neither solved nor failed
        self._rows[row] -= 1
        if episode.progress < 1.0:
            self._rows[max(row - 1, 0)] += 1
        elif row + 1 < self._rows.size:
            self._rows[row + 1] += 1
        else:
            rng = generator(self._seed, "restart", self._restarts)
            self._restarts += 1
            self._rows[int(rng.integers(self._rows.size))] += 1

    def _state(self) -> dict[str, Any]:
        return {"rows": self._rows.tolist(), "restarts": self._restarts}

    def _load(self, state: Mapping[str, Any]) -> None:
        self._rows = np.asarray(state["rows"], dtype=np.int64)
        self._restarts = int(state["restarts"])
