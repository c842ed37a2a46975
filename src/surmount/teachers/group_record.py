"""What a teacher remembers of its groups' episodes, newer ones counting more."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.teachers.cell_groups import CellGroups


class GroupRecord:
    """Discounted successes and episodes of cells, and averages of groups.

    Every episode of a group lets what its cells have seen before count less, by a factor of
    1 − 1/H; so a group that is not practised forgets nothing.

    Parameters
    ----------
    groups
        The cells.
    horizon_episodes, fast_episodes
        H, and the length of the fast average.
    newest_episodes
        Episodes whose single outcomes are kept.

    Attributes
    ----------
    successes, episodes
        Discounted, of each cell, ``(variant,)``.
    fast, slow
        Averages of each group's success, ``(group,)``; both begin with its first outcome.
    total
        Episodes of each group, not discounted, ``(group,)``.
    """

    def __init__(
        self, groups: CellGroups, horizon_episodes: int, fast_episodes: int, newest_episodes: int
    ) -> None:
        self._groups = groups
        self._keep = 1.0 - 1.0 / horizon_episodes
        self._rates = (1.0 / fast_episodes, 1.0 / horizon_episodes)
        self._newest_episodes = newest_episodes
        count = len(groups.names)
        self.successes: FloatArray = np.zeros(groups.cells.count)
        self.episodes: FloatArray = np.zeros(groups.cells.count)
        self._covered: FloatArray = np.full(count, np.nan)
        self.fast: FloatArray = np.zeros(count)
        self.slow: FloatArray = np.zeros(count)
        self.total: IntArray = np.zeros(count, dtype=np.int64)
        self._newest: list[list[int]] = [[] for _ in range(count)]

    @property
    def group_successes(self) -> FloatArray:
        """Discounted successes of each group, ``(group,)``."""
        return self._groups.totals(self.successes)

    @property
    def group_episodes(self) -> FloatArray:
        """Discounted episodes of each group, ``(group,)``."""
        return self._groups.totals(self.episodes)

    @property
    def covered(self) -> FloatArray:
        """Mean share of the way covered, ``(group,)``; NaN where nothing is known of it."""
        return self._covered.copy()

    @property
    def most_new_successes(self) -> int:
        """The largest number of successes among the newest episodes of one group."""
        return max(map(sum, self._newest))

    def add(self, cell: int, *, success: bool, covered: float | None) -> None:
        """Take one episode.

        Parameters
        ----------
        cell
            Its cell.
        success
            Whether it reached its goal.
        covered
            Share of the way that it covered, ``None`` where that is not known.
        """
        group = int(self._groups.group[cell])
        own = self._groups.group == group
        self.successes[own] *= self._keep
        self.episodes[own] *= self._keep
        self.successes[cell] += success
        self.episodes[cell] += 1.0
        for average, rate in zip((self.fast, self.slow), self._rates, strict=True):
            step = rate if self.total[group] else 1.0
            average[group] += step * (float(success) - average[group])
        if covered is not None:
            before = self._covered[group]
            share = 1.0 if np.isnan(before) else self._rates[0]
            self._covered[group] = (1.0 - share) * np.nan_to_num(before) + share * covered
        self.total[group] += 1
        self._newest[group].append(int(success))
        del self._newest[group][: -self._newest_episodes]

    def state(self) -> dict[str, Any]:
        """Return what is saved, as JSON values."""
        return {
            "successes": self.successes.tolist(),
            "episodes": self.episodes.tolist(),
            "covered": [None if np.isnan(value) else float(value) for value in self._covered],
            "fast": self.fast.tolist(),
            "slow": self.slow.tolist(),
            "total": self.total.tolist(),
            "newest": [list(own) for own in self._newest],
        }

    def load(self, state: Mapping[str, Any]) -> None:
        """Take up what :meth:`state` returned."""
        for name in ("successes", "episodes", "fast", "slow"):
            setattr(self, name, np.asarray(state[name], dtype=np.float64))
        self._covered = np.array(
            [np.nan if value is None else float(value) for value in state["covered"]]
        )
        self.total = np.asarray(state["total"], dtype=np.int64)
        self._newest = [[int(value) for value in own] for own in state["newest"]]
