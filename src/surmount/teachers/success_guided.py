"""Success-guided sampling: practise most where success is near a rate wanted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import ConfigError
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.adaptive import AdaptiveTeacher
from surmount.teachers.base import EndedEpisode
from surmount.teachers.cell_groups import CellGroups
from surmount.teachers.changes import Change, ChangeLog


@dataclass(frozen=True, kw_only=True)
class SuccessGuidedConfig:
    """Success-guided sampling, SGS (arXiv:2610.12465)."""

    target: float = 0.66
    """t: success rate at which a task is drawn most (the publication's value for locomotion; 0.5
    for manipulation)."""

    sharpness: float = 5.0
    """κ: how much more tasks near the target are drawn (the publication's value for locomotion; 1
    for manipulation)."""

    floor: float = 0.05
    """ε: added to success and to failure, so that no task's weight is zero (assumed: with it a
    task that always fails is drawn about a thousandth as often as one at the target)."""

    window_episodes: int = 100
    """H: newest episodes of a task from which its success is taken (the publication's value)."""

    review_episodes: int = 20
    """Episodes between two looks at which group is practised most; what is drawn follows every
    episode, this only keeps the log readable (assumed)."""

    def __post_init__(self) -> None:
        for name in ("target", "floor"):
            if not 0 < getattr(self, name) < 1:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy="Give a value between 0 and 1."
                )
        if not 0 < self.sharpness < np.inf:
            raise ConfigError(
                f"`sharpness` is {self.sharpness}.", remedy="Give a positive, finite value."
            )
        for name in ("window_episodes", "review_episodes"):
            if getattr(self, name) < 1:
                raise ConfigError(f"`{name}` is {getattr(self, name)}.", remedy="Give at least 1.")


class SuccessGuidedTeacher(AdaptiveTeacher):
    """Draws cells by (p + ε)^{κt} (1 − p + ε)^{κ(1−t)}, largest near p = t.

    After "Success-guided sampling" (arXiv:2610.12465), over fixed tasks with p their success over
    the newest H episodes. A cell without episodes counts as one at the target, so that each is
    tried soon (assumed). The curriculum's groups decide nothing here; the log tells by them what
    was practised.

    Parameters
    ----------
    groups
        Cells to choose among, and their groups for the log.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    config
        Target, sharpness and window.
    """

    def __init__(
        self, groups: CellGroups, *, total_steps: int, seed: int, config: SuccessGuidedConfig
    ) -> None:
        super().__init__(
            label="success-guided sampling",
            tasks=groups.cells.variants.tolist(),
            total_steps=total_steps,
            seed=seed,
        )
        self._groups = groups
        self._config = config
        self._newest: list[list[float]] = [[] for _ in range(groups.cells.count)]
        self._episodes = 0
        self._main: int | None = None
        self._log = ChangeLog()

    @property
    def changes(self) -> tuple[Change, ...]:
        """All changes of the group that is practised most."""
        return self._log.all

    def success(self) -> FloatArray:
        """Return the success of each cell over its newest episodes, ``(variant,)``."""
        untried = self._config.target
        return np.array([sum(own) / len(own) if own else untried for own in self._newest])

    def weights(self) -> FloatArray:
        """Return the probability of each cell, ``(variant,)``."""
        config = self._config
        weights = guided_weights(self.success(), config.target, config.sharpness, config.floor)
        return weights / weights.sum()

    def distribution(self) -> TaskDistribution:
        """Return cells drawn by their weights."""
        return self._groups.cells.distribution(self.weights())

    def take(self, episode: EndedEpisode) -> None:
        """Add the episode to its cell's window."""
        own = self._newest[self._groups.cells.locate(episode.task)]
        own.append(episode.progress)
        del own[: -self._config.window_episodes]
        self._episodes += 1
        if self._episodes % self._config.review_episodes == 0:
            self._review()

    def _review(self) -> None:
        most, favour = self._groups.practised_most(self.weights())
        if most == self._main:
            return
        names = self._groups.names
        before = None if self._main is None else names[self._main]
        own = [seen for seen, group in zip(self._newest, self._groups.group, strict=True)
               if group == most]  # fmt: skip
        newest = sum(map(len, own))
        self._log.add(
            self._ends_at,
            "main group",
            names[most],
            f"{names[most]} is practised most, {favour:.1f} times as much as by uniform draws: "
            f"{sum(map(sum, own)):.0f} of its newest {newest} episodes succeeded, and success of "
            f"{self._config.target:.0%} is wanted"
            + ("" if before is None else f"; before, {before} was"),
            before=before,
        )
        self._main = most

    def _state(self) -> dict[str, Any]:
        return {
            "newest": [list(own) for own in self._newest],
            "episodes": self._episodes,
            "main": self._main,
            "changes": self._log.state(),
        }

    def _load(self, state: Mapping[str, Any]) -> None:
        self._newest = [[float(value) for value in own] for own in state["newest"]]
        self._episodes = int(state["episodes"])
        self._main = None if state["main"] is None else int(state["main"])
        self._log.load(state["changes"])


def guided_weights(
    success: FloatArray, target: float, sharpness: float, floor: float
) -> FloatArray:
    """Return (p + ε)^{κt} (1 − p + ε)^{κ(1−t)}, of the shape of ``success``.

    Parameters
    ----------
    success
        p, each from 0 to 1.
    target, sharpness, floor
        t, κ and ε.
    """
    easy = (success + floor) ** (sharpness * target)
    return easy * (1.0 - success + floor) ** (sharpness * (1.0 - target))
