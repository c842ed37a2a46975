"""Learnability: practise what succeeds about half of the time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.configuration import absent
from surmount.core.errors import ConfigError
from surmount.tasks.cells import TaskCells
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.adaptive import AdaptiveTeacher
from surmount.teachers.base import EndedEpisode
from surmount.teachers.shares import require_shares, with_uniform_share


@dataclass(frozen=True, kw_only=True)
class LearnabilityConfig:
    """Sampling by p(1 − p) (Tzannetos et al. 2023, Rutherford et al. 2024)."""

    window_episodes: int = 20
    """Newest episodes of a variant from which its success rate p is estimated (assumed)."""

    uniform_share: float = 0.2
    """Share of tasks drawn uniformly, so that p stays known everywhere (assumed)."""

    shrinkage_episodes: float = field(default=2.0, metadata=absent(0.0))
    """Episodes of the pooled success of all variants that each variant's success is mixed with
    (assumed). At a budget of a few episodes a variant no window ever fills; 0 instead adds one
    success and one failure until it does, which makes every variant look half learnt."""

    def __post_init__(self) -> None:
        require_shares(self, "uniform_share")
        if not 0 <= self.shrinkage_episodes < np.inf:
            raise ConfigError(
                f"`shrinkage_episodes` is {self.shrinkage_episodes}.", remedy="Give 0 or more."
            )
        if self.window_episodes < 1:
            raise ConfigError(
                f"`window_episodes` is {self.window_episodes}.", remedy="Give at least 1."
            )


class LearnabilityTeacher(AdaptiveTeacher):
    """Draws variants in proportion to p(1 − p), largest at a success rate of one half.

    After G. Tzannetos et al., "Proximal curriculum for reinforcement learning agents" (TMLR 2023),
    and A. Rutherford et al., "No regrets: investigating and improving regret approximations for
    curriculum discovery" (NeurIPS 2024). The latter estimates p by roll-outs beside training;
    here p is the success of the variant's newest training episodes, drawn towards that of all
    variants' newest episodes, so that a variant not yet tried counts as learnt as the others are.
    ProCuRL draws by a softmax of p(1 − p) and the latter uniformly among the K variants
    where it is largest; here probability is proportional to it, beside a uniform share.

    Parameters
    ----------
    cells
        Variants to choose among.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    config
        Window and uniform share.
    """

    def __init__(
        self, cells: TaskCells, *, total_steps: int, seed: int, config: LearnabilityConfig
    ) -> None:
        super().__init__(
            label="learnability",
            tasks=cells.variants.tolist(),
            total_steps=total_steps,
            seed=seed,
        )
        self._cells = cells
        self._config = config
        self._newest: list[list[float]] = [[] for _ in range(cells.count)]

    def success(self) -> FloatArray:
        """Return the estimated success rate of each variant, ``(variant,)``."""
        full, shrinkage = self._config.window_episodes, self._config.shrinkage_episodes
        successes = np.array([sum(own) for own in self._newest], dtype=np.float64)
        episodes = np.array([len(own) for own in self._newest], dtype=np.float64)
        if shrinkage:
            pooled = (1.0 + successes.sum()) / (2.0 + episodes.sum())
            return (successes + shrinkage * pooled) / (episodes + shrinkage)
        early = (1.0 + successes) / (2.0 + episodes)
        return np.where(episodes == full, successes / full, early)

    def distribution(self) -> TaskDistribution:
        """Return shares in proportion to p(1 − p), beside the uniform share."""
        rate = self.success()
        return self._cells.distribution(
            with_uniform_share(rate * (1.0 - rate), self._config.uniform_share)
        )

    def take(self, episode: EndedEpisode) -> None:
        """Add the episode to its variant's window."""
        own = self._newest[self._cells.locate(episode.task)]
        own.append(episode.progress)
        del own[: -self._config.window_episodes]

    def _state(self) -> dict[str, Any]:
        return {"newest": [list(own) for own in self._newest]}

    def _load(self, state: Mapping[str, Any]) -> None:
        self._newest = [[float(value) for value in own] for own in state["newest"]]
