"""The paper's curriculum as a teacher: level by level, with an automatic test to advance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.tasks.distribution import TaskDistribution, TaskDistributionRecord
from surmount.teachers.advancement import AdvancementConfig, gain_ratio, passes
from surmount.teachers.draws import Draws
from surmount.teachers.state import belongs_to, require_same
from surmount.teachers.teacher import Decision, LevelTest, RolloutOutcome, TeacherStatus

_NAME = "levels"


class LevelTeacher:
    """Trains level after level; each ends by eq. 5 or after a limit of extensions (II-C).

    An iteration ends with the first roll-out that reaches its length, so it may be longer than
    configured by less than one roll-out. The first test of a level, after k steps, compares the
    first iteration with itself: its ratio is 1, and at least one extension follows wherever the
    first iteration gained anything.

    Parameters
    ----------
    levels
        Task distribution of each level, in order. With no levels the teacher is finished at once.
    config
        Lengths and threshold.
    seed
        Of :meth:`sample`.
    """

    def __init__(
        self, levels: Sequence[TaskDistribution], config: AdvancementConfig, *, seed: int = 0
    ) -> None:
        self._levels = tuple(levels)
        self._config = config
        self._level = 0
        self._iteration = 0
        self._steps = 0
        self._first_gain = 0.0
        self._tests: list[LevelTest] = []
        self._draws = Draws(seed)
        self._begin_iteration()

    @property
    def finished(self) -> bool:
        """Whether the last level has been left."""
        return self._level >= len(self._levels)

    @property
    def n_levels(self) -> int:
        """Number of levels."""
        return len(self._levels)

    @property
    def tests(self) -> tuple[LevelTest, ...]:
        """All level tests so far, in order."""
        return tuple(self._tests)

    def status(self) -> TeacherStatus:
        """Say where the teacher stands."""
        if self.finished:
            return TeacherStatus(label="finished", steps=self._steps, planned_steps=self._steps)
        label = f"level {self._level + 1} of {len(self._levels)}"
        if self._iteration:
            label += f", extension {self._iteration}"
        to_come = (len(self._levels) - self._level - 1) * self._config.iteration_steps
        left = max(0, self._iteration_length() - self._iteration_steps)
        return TeacherStatus(
            label=label,
            steps=self._steps,
            planned_steps=self._steps + left + to_come,
            level=self._level + 1,
        )

    def distribution(self) -> TaskDistribution:
        """Return the level's mixture (eq. 4); after the last level, still the last."""
        return self._levels[min(self._level, len(self._levels) - 1)]

    def sample(self, k: int = 1) -> FloatArray:
        """Draw tasks of the level, shape ``(k, parameter)``."""
        return self._draws.draw(self.distribution(), k)

    def update_on_episode(
        self,
        episode_return: float,
        length: int,
        task: FloatArray,
        progress: float,
        env_id: int | None = None,
        *,
        value_error: float | None = None,
    ) -> None:
        """Take an episode's return as rewards of its decisions; see :attr:`tests` for tests."""
        if length > 0:
            self._take(np.full(length, episode_return / length))

    def update_on_rollout(self, outcome: RolloutOutcome) -> LevelTest | None:
        """Take the rewards of a roll-out; test the level where an iteration has ended."""
        return self._take(outcome.rewards)

    def _take(self, rewards: FloatArray) -> LevelTest | None:
        if self.finished:
            return None
        self._collect(rewards)
        if self._iteration_steps < self._iteration_length():
            return None
        test = self._test()
        self._tests.append(test)
        if test.decision == "extend":
            self._iteration += 1
        else:
            self._level += 1
            self._iteration = 0
        self._begin_iteration()
        return test

    def state_dict(self) -> dict[str, Any]:
        """Return level, iteration, reward windows and all tests as JSON values."""
        return {
            **belongs_to(_NAME, self._tasks()),
            "level": self._level,
            "iteration": self._iteration,
            "steps": self._steps,
            "draws": self._draws.calls,
            "iteration_steps": self._iteration_steps,
            "first_gain": self._first_gain,
            "head": self._head.tolist(),
            "tail": self._tail.tolist(),
            "tests": [asdict(test) for test in self._tests],
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state.

        Raises
        ------
        InputError
            If the state was saved by another teacher or under another curriculum.
        """
        require_same(state, _NAME, self._tasks())
        self._level = int(state["level"])
        self._iteration = int(state["iteration"])
        self._steps = int(state["steps"])
        self._draws.calls = int(state.get("draws", 0))
        self._iteration_steps = int(state["iteration_steps"])
        self._first_gain = float(state["first_gain"])
        self._head = np.asarray(state["head"], dtype=np.float64)
        self._tail = np.asarray(state["tail"], dtype=np.float64)
        self._tests = [LevelTest(**test) for test in state["tests"]]

    def _tasks(self) -> list[TaskDistributionRecord]:
        return [level.to_record() for level in self._levels]

    def _begin_iteration(self) -> None:
        self._iteration_steps = 0
        self._head: FloatArray = np.empty(0)
        self._tail: FloatArray = np.empty(0)

    def _iteration_length(self) -> int:
        first = self._iteration == 0
        return self._config.iteration_steps if first else self._config.extension_steps

    def _collect(self, rewards: FloatArray) -> None:
        window = self._config.window_steps
        self._steps += rewards.size
        self._iteration_steps += rewards.size
        self._head = np.concatenate([self._head, rewards[: window - self._head.size]])
        self._tail = np.concatenate([self._tail, rewards])[-window:]

    def _test(self) -> LevelTest:
        config = self._config
        first_window, last_window = float(self._head.sum()), float(self._tail.sum())
        newest_gain = last_window - first_window
        if self._iteration == 0:
            self._first_gain = newest_gain
        ratio = gain_ratio(self._first_gain, newest_gain, gain_floor=config.gain_floor)
        passed = passes(
            self._first_gain,
            newest_gain,
            threshold=config.threshold,
            gain_floor=config.gain_floor,
        )
        decision: Decision
        if passed:
            decision = "advance"
        elif self._iteration >= config.max_extensions:
            decision = "advance at the limit"
        else:
            decision = "extend"
        return LevelTest(
            level=self._level,
            iteration=self._iteration,
            steps=self._steps,
            first_window=first_window,
            last_window=last_window,
            first_gain=self._first_gain,
            newest_gain=newest_gain,
            ratio=ratio,
            threshold=config.threshold,
            decision=decision,
            sentence=self._sentence(first_window, last_window, newest_gain, ratio, decision),
        )

    def _sentence(
        self,
        first_window: float,
        last_window: float,
        newest_gain: float,
        ratio: float | None,
        decision: Decision,
    ) -> str:
        config = self._config
        iteration = f"extension {self._iteration}" if self._iteration else "first iteration"
        if ratio is None:
            verdict = (
                f"the level's first gain {self._first_gain:+.4g} is not above "
                f"{config.gain_floor:g}, so the newest gain decides"
            )
        else:
            verdict = (
                f"newest gain / first gain = {newest_gain:+.4g} / {self._first_gain:+.4g} "
                f"= {ratio:.3f}, threshold {config.threshold:g}"
            )
        action = {
            "advance": "passed: go on to the next level",
            "extend": f"not passed: extend by {config.extension_steps:,} steps",
            "advance at the limit": (
                f"not passed after {config.max_extensions} extensions: go on all the same"
            ),
        }[decision]
        return (
            f"level {self._level + 1}, {iteration}, {self._steps:,} steps: reward over the first "
            f"and last {config.window_steps:,} steps rF = {first_window:.4g}, "
            f"rL = {last_window:.4g}; {verdict}; {action}"
        )
