"""The frontier teacher: practise the groups that are half learnt, rehearse those learnt."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.adaptive import AdaptiveTeacher
from surmount.teachers.base import EndedEpisode
from surmount.teachers.cell_groups import CellGroups
from surmount.teachers.changes import Change, ChangeLog
from surmount.teachers.frontier_config import FrontierConfig
from surmount.teachers.frontier_scores import (
    by_way_covered,
    cell_success,
    frontier_weights,
    novelty,
    success_bounds,
    worth,
)
from surmount.teachers.group_record import GroupRecord
from surmount.teachers.teacher import TeacherStatus


class FrontierTeacher(AdaptiveTeacher):
    """Values groups by how near their pooled success is to a target, and says so.

    A teacher of Surmount's own. Groups are those of a curriculum, usually of behaviour: success is
    estimated per group from about sixty episodes, and a cell's success is drawn to its group's. A
    group is worth the mean of k(p) over its cells times the root of their number, more while its
    success changes and while it was hardly tried; half while it stands still. Tasks are drawn
    uniformly, from mastered or falling groups to rehearse, and from the others by value, within a
    group by k(p). No extra roll-outs are made. Every change is a sentence in the log.

    Parameters
    ----------
    groups
        Cells and their groups.
    total_steps, seed
        As in :class:`~surmount.teachers.adaptive.AdaptiveTeacher`.
    config
        All numbers.
    label
        Name for displays.
    """

    def __init__(
        self,
        groups: CellGroups,
        *,
        total_steps: int,
        seed: int,
        config: FrontierConfig,
        label: str = "frontier",
    ) -> None:
        super().__init__(label=label, tasks=groups.record, total_steps=total_steps, seed=seed)
        self._groups = groups
        self._config = config
        self._record = GroupRecord(
            groups, config.horizon_episodes, config.fast_episodes, config.first_episodes
        )
        count = len(groups.names)
        self._mastered: BoolArray = np.zeros(count, dtype=np.bool_)
        self._falling: BoolArray = np.zeros(count, dtype=np.bool_)
        self._best: FloatArray = np.zeros(count)
        self._mark_at: IntArray = np.zeros(count, dtype=np.int64)
        self._mark: FloatArray = np.zeros(count)
        self._halved_until: IntArray = np.zeros(count, dtype=np.int64)
        self._main: int | None = None
        self._mastered_reviews = 0
        self._stopped_at: int | None = None
        self._log = ChangeLog()

    @property
    def changes(self) -> tuple[Change, ...]:
        """All changes of the main group and of what is mastered, fell or stands still."""
        return self._log.all

    @property
    def finished(self) -> bool:
        """Whether the steps are used up, or all is mastered and that is reason to stop."""
        mastered = self._stopped_at is not None and self._config.stop_when_mastered
        return mastered or super().finished

    def status(self) -> TeacherStatus:
        """Say how many of the steps are done, and which group is the main one."""
        main = "" if self._main is None else f": {self._groups.names[self._main]}"
        return TeacherStatus(
            label=self._label + main, steps=self._steps, planned_steps=self._total_steps
        )

    def group_success(self) -> FloatArray:
        """Return the pooled success of each group, ``(group,)``."""
        return self._bounds()[0]

    def values(self) -> FloatArray:
        """Return what practising each group is worth, ``(group,)``."""
        config, record = self._config, self._record
        if record.most_new_successes < config.first_successes:
            values = by_way_covered(record.covered)
        else:
            change = np.abs(record.fast - record.slow)
            mean = self._groups.totals(self._cell_worth()) / self._groups.sizes
            values = mean * np.sqrt(self._groups.sizes) * (1.0 + config.progress_bonus * change)
        values = values + config.novelty_bonus * novelty(record.total.astype(np.float64))
        return np.where(self._halved_until > record.total.sum(), 0.5 * values, values)

    def weights(self) -> FloatArray:
        """Return the probability of each cell, ``(variant,)``."""
        rehearsed = self._mastered | self._falling
        return frontier_weights(
            self._groups,
            self.values(),
            self._cell_worth(),
            self._mastered,
            rehearsed,
            self._config,
        )

    def distribution(self) -> TaskDistribution:
        """Return cells drawn by their weights."""
        return self._groups.cells.distribution(self.weights())

    def take(self, episode: EndedEpisode) -> None:
        """Count the episode; review the groups every so many episodes."""
        self._record.add(
            self._groups.cells.locate(episode.task),
            success=episode.progress >= 1.0,
            covered=episode.covered,
        )
        if self._record.total.sum() % self._config.review_episodes == 0:
            self._review()

    def _bounds(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        record = self._record
        return success_bounds(
            record.group_successes, record.group_episodes, self._config.bound_tail
        )

    def _cell_worth(self) -> FloatArray:
        record, by_group = self._record, self.group_success()
        success = cell_success(
            record.successes,
            record.episodes,
            by_group[self._groups.group],
            self._config.shrinkage_episodes,
        )
        return worth(success, self._config)

    def _review(self) -> None:
        success, low, _ = self._bounds()
        for group in range(success.size):
            self._review_mastery(group, float(success[group]), float(low[group]))
        if self._main is not None:
            self._review_plateau(self._main, float(success[self._main]))
        self._review_main(success)
        self._review_end(success)

    def _review_mastery(self, group: int, success: float, low: float) -> None:
        config, name = self._config, self._groups.names[group]
        episodes = float(self._record.group_episodes[group])
        known = episodes >= config.mastered_episodes
        if known:
            self._best[group] = max(self._best[group], low)
        fell_by = float(self._best[group]) - success
        falling = fell_by > config.fallen_by
        if falling and not self._falling[group]:
            self._mastered[group] = False
            self._log.add(
                self._ends_at,
                "fell",
                name,
                f"{name} fell: success {success:.0%}, {100 * fell_by:.0f} points below its best "
                f"lower bound of {self._best[group]:.0%}; it is rehearsed",
            )
        self._falling[group] = falling
        if known and low >= config.mastered_bound and not self._mastered[group]:
            self._mastered[group] = True
            self._log.add(
                self._ends_at,
                "mastered",
                name,
                f"{name} is mastered: success {success:.0%} over about {episodes:.0f} episodes, at "
                f"least {low:.0%} with {1 - config.bound_tail:.0%} certainty; from now on it is "
                "rehearsed",
            )

    def _review_plateau(self, group: int, success: float) -> None:
        config, record = self._config, self._record
        seen = int(record.total[group] - self._mark_at[group])
        if seen < config.plateau_episodes:
            return
        rise = success - float(self._mark[group])
        if success < config.target and rise < config.plateau_rise and not self._mastered[group]:
            self._halved_until[group] = record.total.sum() + config.plateau_episodes
            name = self._groups.names[group]
            self._log.add(
                self._ends_at,
                "plateau",
                name,
                f"{name} stands still: success {success:.0%}, {100 * rise:+.0f} points over {seen} "
                f"episodes; its value is halved for {config.plateau_episodes} episodes",
            )
        self._mark_here(group, success)

    def _mark_here(self, group: int, success: float) -> None:
        self._mark_at[group] = self._record.total[group]
        self._mark[group] = success

    def _review_main(self, success: FloatArray) -> None:
        values = np.where(self._mastered, -1.0, self.values())
        main = int(values.argmax())
        if self._mastered.all() or main == self._main:
            return
        before = self._main
        if (
            before is not None
            and values[before] > 0
            and values[main] < self._config.switch_margin * values[before]
        ):
            return
        names = self._groups.names
        seen = int(self._record.total[main])
        said = f"success {success[main]:.0%} over {seen} episode{'s' * (seen != 1)}"
        if self._record.most_new_successes < self._config.first_successes:
            said = "hardly anything succeeds yet, so groups are ranked by the way covered"
        after = ""
        if before is not None:
            value = "mastered" if self._mastered[before] else f"value {values[before]:.2f}"
            after = f"; before, {names[before]} was (success {success[before]:.0%}, {value})"
        self._log.add(
            self._ends_at,
            "main group",
            names[main],
            f"{names[main]} becomes the main group, of value {values[main]:.2f}: {said}{after}",
            before=None if before is None else names[before],
        )
        self._main = main
        self._mark_here(main, float(success[main]))

    def _review_end(self, success: FloatArray) -> None:
        self._mastered_reviews = self._mastered_reviews + 1 if self._mastered.all() else 0
        if self._mastered_reviews < 2 or self._stopped_at is not None:
            return
        self._stopped_at = self._ends_at
        left = max(0, self._total_steps - self._ends_at)
        verb = "are" if self._config.stop_when_mastered else "would be"
        rates = ", ".join(
            f"{name} {rate:.0%}" for name, rate in zip(self._groups.names, success, strict=True)
        )
        self._log.add(
            self._ends_at,
            "stop",
            self._groups.names[int(success.argmin())],
            f"all groups are mastered in two reviews in a row ({rates}): {left:,} of "
            f"{self._total_steps:,} steps {verb} saved by stopping here",
        )

    def _state(self) -> dict[str, Any]:
        return {
            "record": self._record.state(),
            "mastered": self._mastered.tolist(),
            "falling": self._falling.tolist(),
            "best": self._best.tolist(),
            "mark_at": self._mark_at.tolist(),
            "mark": self._mark.tolist(),
            "halved_until": self._halved_until.tolist(),
            "main": self._main,
            "mastered_reviews": self._mastered_reviews,
            "stopped_at": self._stopped_at,
            "changes": self._log.state(),
        }

    def _load(self, state: Mapping[str, Any]) -> None:
        self._record.load(state["record"])
        self._mastered = np.asarray(state["mastered"], dtype=np.bool_)
        self._falling = np.asarray(state["falling"], dtype=np.bool_)
        self._best = np.asarray(state["best"], dtype=np.float64)
        self._mark_at = np.asarray(state["mark_at"], dtype=np.int64)
        self._mark = np.asarray(state["mark"], dtype=np.float64)
        self._halved_until = np.asarray(state["halved_until"], dtype=np.int64)
        self._main = None if state["main"] is None else int(state["main"])
        self._mastered_reviews = int(state["mastered_reviews"])
        stopped = state["stopped_at"]
        self._stopped_at = None if stopped is None else int(stopped)
        self._log.load(state["changes"])
