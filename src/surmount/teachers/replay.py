"""Prioritised level replay: practise again what the critic judged worst."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import ConfigError, InputError
from surmount.tasks.cells import TaskCells
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.adaptive import AdaptiveTeacher
from surmount.teachers.base import EndedEpisode


@dataclass(frozen=True, kw_only=True)
class ReplayConfig:
    """Prioritised level replay (Jiang et al. 2021)."""

    temperature: float = 0.1
    """β: the k-th highest score gets a weight of k^(−1/β) (the publication's value)."""

    staleness: float = 0.1
    """ρ: share of replays drawn by how long ago a level was last played (the publication's)."""

    def __post_init__(self) -> None:
        if not self.temperature > 0:
            raise ConfigError(
                f"`temperature` is {self.temperature}.", remedy="Give a positive value."
            )
        if not 0 <= self.staleness <= 1:
            raise ConfigError(
                f"`staleness` is {self.staleness}.", remedy="Give a share from 0 to 1."
            )


class ReplayTeacher(AdaptiveTeacher):
    """Replays variants by the rank of their value error, and those not played for long.

    After M. Jiang, E. Grefenstette and T. Rocktäschel, "Prioritized level replay" (ICML 2021). A
    level is a variant; its score is the mean magnitude of the generalised advantage in its newest
    episode. As long as variants are unseen, one of these is drawn with the share of variants that
    are unseen (the publication's proportional schedule); else a seen one is replayed, by
    (1 − ρ) P_S + ρ P_C, P_S by rank of score and P_C by staleness.

    Parameters
    ----------
    cells
        Variants to choose among.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    config
        Temperature and staleness.
    """

    needs_value_errors = True
    """Only learners with a critic that estimates advantages can have it."""

    def __init__(
        self, cells: TaskCells, *, total_steps: int, seed: int, config: ReplayConfig
    ) -> None:
        super().__init__(
            label="prioritised level replay",
            tasks=cells.variants.tolist(),
            total_steps=total_steps,
            seed=seed,
        )
        self._cells = cells
        self._config = config
        self._episodes = 0
        self._score: FloatArray = np.zeros(cells.count)
        self._last: IntArray = np.full(cells.count, -1, dtype=np.int64)

    def distribution(self) -> TaskDistribution:
        """Return unseen variants by their share, and seen ones by score and staleness."""
        seen = self._last >= 0
        weights = np.where(seen, 0.0, 1.0 / seen.size)  # adds up to the share that is unseen
        if seen.any():
            weights[seen] = seen.mean() * self._replay(self._score[seen], self._last[seen])
        return self._cells.distribution(weights)

    def take(self, episode: EndedEpisode) -> None:
        """Take the score of the episode's variant.

        Raises
        ------
        InputError
            If there is no value error.
        """
        if episode.value_error is None:
            raise InputError(
                "Prioritised level replay needs the value error of each episode.",
                remedy="Train by an actor-critic learner: `surmount.learn.trainer.Trainer`, or PPO "
                "or A2C of Stable-Baselines3 with the callback.",
            )
        cell = self._cells.locate(episode.task)
        self._score[cell] = episode.value_error
        self._last[cell] = self._episodes
        self._episodes += 1

    def _replay(self, score: FloatArray, last: IntArray) -> FloatArray:
        rank = np.empty(score.size)
        rank[np.argsort(-score, kind="stable")] = np.arange(1, score.size + 1)
        by_score = rank ** (-1.0 / self._config.temperature)
        age = (self._episodes - 1 - last).astype(np.float64)
        by_age = age if age.any() else np.ones(score.size)
        share = self._config.staleness
        return (1.0 - share) * by_score / by_score.sum() + share * by_age / by_age.sum()

    def _state(self) -> dict[str, Any]:
        return {
            "episodes": self._episodes,
            "score": self._score.tolist(),
            "last": self._last.tolist(),
        }

    def _load(self, state: Mapping[str, Any]) -> None:
        self._episodes = int(state["episodes"])
        self._score = np.asarray(state["score"], dtype=np.float64)
        self._last = np.asarray(state["last"], dtype=np.int64)
