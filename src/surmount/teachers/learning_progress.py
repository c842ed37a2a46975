"""Learning progress: practise where success is changing, up or down."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.tasks.cells import TaskCells
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.adaptive import AdaptiveTeacher
from surmount.teachers.base import EndedEpisode
from surmount.teachers.shares import require_shares, with_uniform_share


@dataclass(frozen=True, kw_only=True)
class LearningProgressConfig:
    """Bidirectional learning progress (Kanitscheider et al. 2021)."""

    fast_rate: float = 0.2
    """Share of the newest episode in a variant's fast average of success. The publication averages
    over thousands of episodes per task; a variant sees a hundred here (assumed)."""

    slow_rate: float = 0.05
    """The same for the slow average (assumed)."""

    low_success_emphasis: float = 0.1
    """p_θ of the publication: smaller values weigh progress at low success more."""

    uniform_share: float = 0.2
    """Share of tasks drawn uniformly, so that no variant is forgotten (assumed)."""

    def __post_init__(self) -> None:
        require_shares(self)


class LearningProgressTeacher(AdaptiveTeacher):
    """Draws variants in proportion to how fast their success changes.

    After I. Kanitscheider et al., "Multi-task curriculum learning in a complex, visual,
    hard-exploration domain: Minecraft" (arXiv:2106.14876, 2021): two exponential averages of
    success per task, one fast and one slow, each reweighted towards low success; the progress is
    the magnitude of their difference, so that forgetting counts as well. Both averages begin with
    the variant's first outcome, so what always succeeds shows no progress. The publication draws
    by a sigmoid of standardised progress; here probability is proportional to progress, beside a
    uniform share.

    Parameters
    ----------
    cells
        Variants to choose among.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    config
        Rates of the averages.
    """

    def __init__(
        self, cells: TaskCells, *, total_steps: int, seed: int, config: LearningProgressConfig
    ) -> None:
        super().__init__(
            label="learning progress",
            tasks=cells.variants.tolist(),
            total_steps=total_steps,
            seed=seed,
        )
        self._cells = cells
        self._config = config
        self._fast: FloatArray = np.zeros(cells.count)
        self._slow: FloatArray = np.zeros(cells.count)
        self._tried: BoolArray = np.zeros(cells.count, dtype=np.bool_)

    def progress(self) -> FloatArray:
        """Return the learning progress of each variant, ``(variant,)``."""
        emphasis = self._config.low_success_emphasis
        return np.abs(_reweighted(self._fast, emphasis) - _reweighted(self._slow, emphasis))

    def distribution(self) -> TaskDistribution:
        """Return shares in proportion to progress, beside the uniform share."""
        return self._cells.distribution(
            with_uniform_share(self.progress(), self._config.uniform_share)
        )

    def take(self, episode: EndedEpisode) -> None:
        """Move both averages of the episode's variant."""
        cell = self._cells.locate(episode.task)
        if not self._tried[cell]:
            self._tried[cell] = True
            self._fast[cell] = self._slow[cell] = episode.progress
            return
        self._fast[cell] += self._config.fast_rate * (episode.progress - self._fast[cell])
        self._slow[cell] += self._config.slow_rate * (episode.progress - self._slow[cell])

    def _state(self) -> dict[str, Any]:
        return {
            "fast": self._fast.tolist(),
            "slow": self._slow.tolist(),
            "tried": self._tried.tolist(),
        }

    def _load(self, state: Mapping[str, Any]) -> None:
        self._fast = np.asarray(state["fast"], dtype=np.float64)
        self._slow = np.asarray(state["slow"], dtype=np.float64)
        self._tried = np.asarray(state["tried"], dtype=np.bool_)


def _reweighted(success: FloatArray, emphasis: float) -> FloatArray:
    """Return the publication's map of [0, 1] onto itself that stretches low success."""
    return (1.0 - emphasis) * success / (success + emphasis * (1.0 - 2.0 * success))
