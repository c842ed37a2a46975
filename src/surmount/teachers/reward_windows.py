"""r of eq. 5 at the start and the end of an iteration, by episodes or by learning steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.teachers.teacher import RewardMeasure

Ended = tuple[int, float]
"""Learning step of the iteration, from 1, at which an episode ended, and its reward."""


@dataclass(frozen=True, kw_only=True)
class WindowRewards:
    """What both windows of an iteration hold.

    Attributes
    ----------
    first, last
        rF and rL; ``None`` where no episode ended in the iteration.
    gain
        rL − rF; ``None`` also where both windows hold the same episodes.
    first_steps, last_steps
        Learning steps that the windows reach over: W, or more where none ended within W.
    first_episodes, last_episodes
        Episodes in each; ``None`` by steps.
    """

    first: float | None
    last: float | None
    gain: float | None
    first_steps: int
    last_steps: int
    first_episodes: int | None = None
    last_episodes: int | None = None


class RewardWindows(Protocol):
    """Collects the rewards of one iteration."""

    @property
    def steps(self) -> int:
        """Learning steps of the iteration so far."""
        ...

    def add(self, rewards: FloatArray, ends: IntArray, returns: FloatArray) -> None:
        """Take further learning steps.

        Parameters
        ----------
        rewards
            Of each learning step, ``(step,)``.
        ends
            At which of these steps episodes ended, from 1, ``(episode,)``.
        returns
            Their rewards, ``(episode,)``.
        """
        ...

    def read(self) -> WindowRewards:
        """Return what the windows hold now."""
        ...

    def state_dict(self) -> dict[str, Any]:
        """Return everything as JSON values."""
        ...

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        ...


class StepWindows:
    """The sum of the rewards of the first and the last W learning steps.

    Parameters
    ----------
    window_steps
        W.
    """

    def __init__(self, window_steps: int) -> None:
        self._window_steps = window_steps
        self._steps = 0
        self._head: FloatArray = np.empty(0)
        self._tail: FloatArray = np.empty(0)

    @property
    def steps(self) -> int:
        """Learning steps of the iteration so far."""
        return self._steps

    def add(self, rewards: FloatArray, ends: IntArray, returns: FloatArray) -> None:  # noqa: ARG002
        """Take further learning steps; episodes do not matter."""
        self._steps += rewards.size
        self._head = np.concatenate([self._head, rewards[: self._window_steps - self._head.size]])
        self._tail = np.concatenate([self._tail, rewards])[-self._window_steps :]

    def read(self) -> WindowRewards:
        """Return both sums."""
        first, last = float(self._head.sum()), float(self._tail.sum())
        return WindowRewards(
            first=first,
            last=last,
            gain=last - first,
            first_steps=self._head.size,
            last_steps=self._tail.size,
        )

    def state_dict(self) -> dict[str, Any]:
        """Return steps and rewards of both windows."""
        return {"steps": self._steps, "head": self._head.tolist(), "tail": self._tail.tolist()}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        self._steps = int(state["steps"])
        self._head = np.asarray(state["head"], dtype=np.float64)
        self._tail = np.asarray(state["tail"], dtype=np.float64)


class EpisodeWindows:
    """The mean reward of the episodes that ended within the first and the last W learning steps.

    An episode counts where it ended, wherever it began, as in ML-Agents' cumulative reward: so the
    first window of a level also holds episodes that were begun under the level before. Where none
    ended within the first W steps, the first to end in the iteration count instead, and where none
    ended within the last W, the last to end; several that ended at the same moment count together.

    Parameters
    ----------
    window_steps
        W.
    """

    def __init__(self, window_steps: int) -> None:
        self._window_steps = window_steps
        self._steps = 0
        self._head: list[Ended] = []
        self._tail: list[Ended] = []

    @property
    def steps(self) -> int:
        """Learning steps of the iteration so far."""
        return self._steps

    def add(self, rewards: FloatArray, ends: IntArray, returns: FloatArray) -> None:
        """Take further learning steps and the episodes that ended in them.

        Raises
        ------
        InputError
            If an episode ended at none of these steps.
        """
        if ends.size and not 0 < ends.min() <= ends.max() <= rewards.size:
            raise InputError(
                f"An episode ended at step {int(ends.max())} or {int(ends.min())} of a roll-out of "
                f"{rewards.size} steps.",
                remedy="Count `episodes.step` over all learning steps, and say by `steps_before` "
                "how many were before the roll-out.",
            )
        ended = [(self._steps + int(end), float(value))
                 for end, value in zip(ends, returns, strict=True)]  # fmt: skip
        self._steps += rewards.size
        reach = self._reach(ended)
        self._head = [one for one in self._head + ended if one[0] <= reach]
        self._tail += ended
        begin = self._begin()
        self._tail = [one for one in self._tail if one[0] > begin]

    def read(self) -> WindowRewards:
        """Return both means."""
        first, last = _mean(self._head), _mean(self._tail)
        gain = None if first is None or last is None else last - first
        return WindowRewards(
            first=first,
            last=last,
            gain=gain if self._head != self._tail else None,
            first_steps=self._reach([]),
            last_steps=self._steps - self._begin(),
            first_episodes=len(self._head),
            last_episodes=len(self._tail),
        )

    def state_dict(self) -> dict[str, Any]:
        """Return steps and the episodes of both windows."""
        return {
            "steps": self._steps,
            "head": [list(one) for one in self._head],
            "tail": [list(one) for one in self._tail],
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        self._steps = int(state["steps"])
        self._head = [(int(step), float(value)) for step, value in state["head"]]
        self._tail = [(int(step), float(value)) for step, value in state["tail"]]

    def _reach(self, ended: list[Ended]) -> int:
        """Return the last step of the first window."""
        return max(self._window_steps, min((step for step, _ in self._head + ended), default=0))

    def _begin(self) -> int:
        """Return the step after which the last window begins."""
        newest = max((step for step, _ in self._tail), default=self._steps)
        return min(self._steps - self._window_steps, newest - 1)


def make_windows(measure: RewardMeasure, window_steps: int) -> RewardWindows:
    """Return empty windows.

    Parameters
    ----------
    measure
        What r is.
    window_steps
        W.
    """
    return EpisodeWindows(window_steps) if measure == "episode" else StepWindows(window_steps)


def _mean(ended: list[Ended]) -> float | None:
    return float(np.mean([value for _, value in ended])) if ended else None
