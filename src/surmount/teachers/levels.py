"""The paper's curriculum as a teacher: level by level, with an automatic test to advance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import ConfigError, InputError
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.advancement import AdvancementConfig, deciding_rule, gain_ratio, passes
from surmount.teachers.base import BaseTeacher, EndedEpisode
from surmount.teachers.draws import Draws
from surmount.teachers.reward_windows import RewardWindows, make_windows
from surmount.teachers.sentence import sentence_of
from surmount.teachers.teacher import Decision, LevelTest, TeacherStatus


def require_levels(levels: Sequence[object]) -> None:
    """Refuse a curriculum without levels.

    Raises
    ------
    ConfigError
        If there are none.
    """
    if not levels:
        raise ConfigError(
            "The curriculum has no levels: every group already succeeds.",
            remedy="Shorten the initiation, so that something is left to learn.",
        )


class LevelTeacher(BaseTeacher):
    """Trains level after level; each ends by eq. 5 or after a limit of extensions (II-C).

    An iteration ends with the first roll-out that reaches its length, so it may be longer than
    configured by less than one roll-out. The first test of a level, after k steps, compares the
    first iteration with itself: its ratio is 1, and an extension follows unless none is allowed
    (docs/adr/0073).

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
        super().__init__(
            name="levels", tasks=[level.to_record() for level in levels], draws=Draws(seed)
        )
        self._levels = tuple(levels)
        self._config = config
        self._level = 0
        self._iteration = 0
        self._first_gain: float | None = None
        self._tests: list[LevelTest] = []
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
        config, further = self._config, len(self._levels) - self._level - 1
        left = max(0, self._iteration_length() - self._windows.steps)
        first_test_extends = self._iteration == 0 and config.max_extensions > 0
        to_pass = left + config.extension_steps if first_test_extends else left
        return TeacherStatus(
            label=label,
            steps=self._steps,
            planned_steps=self._steps + left + further * config.iteration_steps,
            level=self._level + 1,
            steps_to_test=left,
            steps_to_next_level=to_pass if further else None,
        )

    def distribution(self) -> TaskDistribution:
        """Return the level's mixture (eq. 4); after the last level, still the last.

        Raises
        ------
        ConfigError
            If there are no levels.
        """
        require_levels(self._levels)
        return self._levels[min(self._level, len(self._levels) - 1)]

    def take_steps(
        self, rewards: FloatArray, ends: IntArray, episodes: Sequence[EndedEpisode]
    ) -> LevelTest | None:
        """Take rewards and ends of episodes; test the level where an iteration has ended."""
        if self.finished or rewards.size == 0:
            return None
        returns = np.array([episode.episode_return for episode in episodes])
        self._windows.add(rewards, ends, returns)
        self._steps += rewards.size
        if self._windows.steps < self._iteration_length():
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

    def _state(self) -> dict[str, Any]:
        return {
            "level": self._level,
            "iteration": self._iteration,
            "measure": self._config.measure,
            "windows": self._windows.state_dict(),
            "first_gain": self._first_gain,
            "tests": [asdict(test) for test in self._tests],
        }

    def _load(self, state: Mapping[str, Any]) -> None:
        # States from before there was a choice are by steps, with the windows among the rest.
        measure = state.get("measure", "step")
        if measure != self._config.measure:
            raise InputError(
                f"The saved progress measures reward by {measure}, not by {self._config.measure}.",
                remedy=f"Resume with `advancement.measure={measure}`, or start afresh.",
            )
        windows = state.get("windows")
        if windows is None:
            windows = {key: state[key] for key in ("head", "tail")}
            windows["steps"] = state["iteration_steps"]
        self._level = int(state["level"])
        self._iteration = int(state["iteration"])
        first_gain = state["first_gain"]
        self._first_gain = None if first_gain is None else float(first_gain)
        self._windows.load_state_dict(windows)
        self._tests = [LevelTest(**test) for test in state["tests"]]

    def _begin_iteration(self) -> None:
        config = self._config
        self._windows: RewardWindows = make_windows(config.measure, config.window_steps)

    def _iteration_length(self) -> int:
        first = self._iteration == 0
        return self._config.iteration_steps if first else self._config.extension_steps

    def _test(self) -> LevelTest:
        config, windows = self._config, self._windows.read()
        if self._iteration == 0:
            self._first_gain = windows.gain
        first, newest, floor = self._first_gain, windows.gain, config.gain_floor
        passed = passes(
            first,
            newest,
            iteration=self._iteration,
            threshold=config.threshold,
            gain_floor=floor,
        )
        decision: Decision
        if passed:
            decision = "advance"
        elif self._iteration >= config.max_extensions:
            decision = "advance at the limit"
        else:
            decision = "extend"
        test = LevelTest(
            level=self._level,
            iteration=self._iteration,
            steps=self._steps,
            first_window=windows.first,
            last_window=windows.last,
            first_gain=first,
            newest_gain=newest,
            ratio=gain_ratio(first, newest, gain_floor=floor),
            threshold=config.threshold,
            decision=decision,
            sentence="",
            measure=config.measure,
            first_episodes=windows.first_episodes,
            last_episodes=windows.last_episodes,
            rule=deciding_rule(first, newest, iteration=self._iteration, gain_floor=floor),
        )
        return replace(test, sentence=sentence_of(test, windows, config))
