"""How much the critic erred on each episode, which may have begun in an earlier roll-out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray


class EpisodeErrors:
    """Averages the magnitude of generalised advantages over episodes.

    Parameters
    ----------
    num_envs
        Environments that learn at once.
    """

    def __init__(self, num_envs: int) -> None:
        self._sum: FloatArray = np.zeros(num_envs)
        self._count: FloatArray = np.zeros(num_envs)

    def add(self, advantages: np.ndarray, ends: Sequence[tuple[int, int]]) -> FloatArray:
        """Take the advantages of a roll-out.

        Parameters
        ----------
        advantages
            Shape ``(step, env)``.
        ends
            Step and environment of each episode's last step, in the order in which they ended.

        Returns
        -------
        FloatArray
            Mean magnitude over each of these episodes, ``(episode,)``.
        """
        magnitudes = np.abs(np.asarray(advantages, dtype=np.float64))
        begin = np.zeros(self._sum.size, dtype=np.int64)
        means = np.empty(len(ends))
        for index, (step, env) in enumerate(ends):
            own = magnitudes[begin[env] : step + 1, env]
            means[index] = (self._sum[env] + own.sum()) / (self._count[env] + own.size)
            self._sum[env] = self._count[env] = 0.0
            begin[env] = step + 1
        for env in range(self._sum.size):
            own = magnitudes[begin[env] :, env]
            self._sum[env] += own.sum()
            self._count[env] += own.size
        return means

    def state_dict(self) -> dict[str, Any]:
        """Return the sums over unfinished episodes."""
        return {"sum": self._sum.copy(), "count": self._count.copy()}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        self._sum = np.array(state["sum"], dtype=np.float64)
        self._count = np.array(state["count"], dtype=np.float64)
