"""The paper's levels, gone through by mastery: skipped, left and gone back from by success."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import ConfigError
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.regions import Regions
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.base import BudgetTeacher, EndedEpisode
from surmount.teachers.changes import Change, ChangeKind, ChangeLog
from surmount.teachers.draws import Draws
from surmount.teachers.shares import with_uniform_share
from surmount.teachers.teacher import TeacherStatus


@dataclass(frozen=True, kw_only=True)
class MasteryConfig:
    """Mastery-gated levels: when a level is skipped, left or gone back from."""

    leave_success: float = 0.9
    """Success of the level's own group from which the level is over, or is not begun (assumed: the
    paper calls a group learnt from 95 % in trials; training explores and starts anywhere)."""

    back_success: float = 0.05
    """Success of the level's own group below which, after k steps in the level, the level before is
    gone back to (assumed: two or fewer of fifty are luck)."""

    window_episodes: int = 50
    """Newest episodes of a group that its success is taken from; before there are so many nothing
    is decided by it (assumed: its standard error is 4 points at 90 %)."""

    last_uniform_share: float = 0.3
    """Once all levels are over, groups are weighed by 1 − success beside this share for all alike
    (of our networks, groups practised by a twentieth were forgotten, by a tenth not)."""

    def __post_init__(self) -> None:
        if not 0 <= self.back_success < self.leave_success <= 1:
            raise ConfigError(
                f"`back_success` ({self.back_success}) and `leave_success` ({self.leave_success}) "
                "are no rates in ascending order.",
                remedy="Let 0 ≤ back_success < leave_success ≤ 1.",
            )
        if self.window_episodes < 1:
            raise ConfigError(
                f"`window_episodes` is {self.window_episodes}.", remedy="Give at least 1."
            )
        if not 0 < self.last_uniform_share <= 1:
            raise ConfigError(
                f"`last_uniform_share` is {self.last_uniform_share}.",
                remedy="Give a value above 0 and at most 1.",
            )


class MasteryTeacher(BudgetTeacher):
    """Goes through the paper's levels by the success of each level's own group.

    A level is skipped or left as soon as its dominant group succeeds in enough of its newest
    episodes; after k steps, if hardly any of them succeeded, the level before is gone back to for
    at least p steps; after the paper's limit (k and all extensions) it is left whatever its
    success. Once all levels are over, all groups are practised by 1 − success until the steps are
    used up. Eq. 5 decides nothing: it tells that reward stands still, not whether at the top or at
    the bottom.

    Parameters
    ----------
    curriculum
        Groups and levels; at least one level.
    advancement
        k, p and the number of extensions.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    config
        Rates and window.
    """

    def __init__(
        self,
        curriculum: Curriculum,
        advancement: AdvancementConfig,
        *,
        total_steps: int,
        seed: int,
        config: MasteryConfig,
    ) -> None:
        super().__init__(
            label="mastery-gated levels",
            total_steps=total_steps,
            name="mastery-gated levels",
            tasks=curriculum.to_record(),
            draws=Draws(seed),
        )
        self._curriculum = curriculum
        self._regions = Regions.of(curriculum)
        self._k_steps = advancement.iteration_steps
        self._p_steps = advancement.extension_steps
        self._most_steps = self._k_steps + advancement.max_extensions * self._p_steps
        self._config = config
        self._names = tuple(group.name for group in curriculum.groups)
        self._newest: list[list[float]] = [[] for _ in self._names]
        self._level = 0
        self._entered = 0
        self._held_until = 0
        self._log = ChangeLog()

    @property
    def changes(self) -> tuple[Change, ...]:
        """All levels skipped, left, and gone back from."""
        return self._log.all

    def status(self) -> TeacherStatus:
        """Say which level is in force."""
        count = self._curriculum.n_levels
        over = self._level >= count
        return TeacherStatus(
            label="after the last level" if over else f"level {self._level + 1} of {count}",
            steps=self._steps,
            planned_steps=self._total_steps,
            level=min(self._level + 1, count),
        )

    def distribution(self) -> TaskDistribution:
        """Return the level's mixture (eq. 4); after the last level, groups by 1 − success."""
        if self._level < self._curriculum.n_levels:
            return self._curriculum.level_distribution(self._level)
        failure = np.array([1.0 - (1.0 + sum(own)) / (2.0 + len(own)) for own in self._newest])
        return self._mixture(with_uniform_share(failure, self._config.last_uniform_share))

    def take_steps(
        self, rewards: FloatArray, ends: IntArray, episodes: Sequence[EndedEpisode]
    ) -> None:
        """Take the episodes in the order in which they ended; change the level after each."""
        for end, episode in zip(ends, episodes, strict=True):
            group = int(self._regions.index(episode.task[None])[0])
            if group >= 0:
                self._newest[group].append(episode.progress)
                del self._newest[group][: -self._config.window_episodes]
            self._decide(self._steps + int(end))
        self._steps += rewards.size

    def _decide(self, now: int) -> None:
        """Leave, skip or go back from levels as long as there is a reason to."""
        config, entered_now = self._config, False
        while self._level < self._curriculum.n_levels:
            group = self._names.index(self._curriculum.levels[self._level].dominant)
            success, inside = self._success(group), now - self._entered
            said = f"{success:.0%} of its newest {config.window_episodes} episodes succeeded"
            if success >= config.leave_success and now >= self._held_until:
                self._move(
                    self._level + 1,
                    now,
                    "skipped" if entered_now else "left",
                    f"{said}, at least {config.leave_success:.0%}",
                )
            elif inside >= self._most_steps:
                reached = "success unknown" if success < 0 else said
                self._move(self._level + 1, now, "left", f"{reached}, after {inside:,} steps")
            elif 0 <= success < config.back_success and inside >= self._k_steps and self._level:
                self._held_until = now + self._p_steps
                limit = f"below {config.back_success:.0%} after {inside:,} steps"
                self._move(self._level - 1, now, "back", f"{said}, {limit}")
                return
            else:
                return
            entered_now = True

    def _success(self, group: int) -> float:
        """Return the success of a group's newest episodes, −1 before there are enough."""
        own = self._newest[group]
        return sum(own) / len(own) if len(own) == self._config.window_episodes else -1.0

    def _move(self, level: int, now: int, kind: ChangeKind, why: str) -> None:
        levels = self._curriculum.levels
        dominant = levels[self._level].dominant
        if level < len(levels):
            goal = f"level {level + 1} begins, mainly {levels[level].dominant}"
        else:
            goal = "no level is left, and groups are weighed by 1 − success"
        verb = {"skipped": "is skipped", "left": "is left", "back": "is gone back from"}[kind]
        self._log.add(
            now,
            kind,
            dominant,
            f"level {self._level + 1} ({dominant}) {verb}: {why}; {goal}",
            before=dominant,
        )
        self._level, self._entered = level, now

    def _mixture(self, weights: FloatArray) -> TaskDistribution:
        parts = [self._curriculum.group_distribution(group) for group in range(weights.size)]
        return TaskDistribution(
            parameters=self._curriculum.parameters,
            weights=np.concatenate(
                [share * part.weights for share, part in zip(weights, parts, strict=True)]
            ),
            lower=np.concatenate([part.lower for part in parts]),
            upper=np.concatenate([part.upper for part in parts]),
            axes=self._curriculum.axes,
        )

    def _state(self) -> dict[str, Any]:
        return {
            "newest": [list(own) for own in self._newest],
            "level": self._level,
            "entered": self._entered,
            "held_until": self._held_until,
            "changes": self._log.state(),
        }

    def _load(self, state: Mapping[str, Any]) -> None:
        self._newest = [[float(value) for value in own] for own in state["newest"]]
        self._level = int(state["level"])
        self._entered = int(state["entered"])
        self._held_until = int(state["held_until"])
        self._log.load(state["changes"])
