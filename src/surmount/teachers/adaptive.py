"""What teachers share whose distribution follows from the episodes that ended."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.draws import Draws
from surmount.teachers.state import belongs_to, require_same
from surmount.teachers.teacher import RolloutOutcome, TeacherStatus


@dataclass(frozen=True, kw_only=True, eq=False)
class EndedEpisode:
    """What a teacher is told of one episode.

    Attributes
    ----------
    episode_return, length, task, progress, env_id, value_error
        As the arguments of :meth:`surmount.teachers.teacher.Teacher.update_on_episode`.
    """

    episode_return: float
    length: int
    task: FloatArray
    progress: float
    env_id: int | None
    value_error: float | None


class AdaptiveTeacher(ABC):
    """A teacher for a fixed number of steps whose distribution depends on episodes alone.

    Environments draw from the distribution inside ``reset`` until the next one is pushed, after
    each roll-out. The distribution is a function of the seed and of the saved state, so asking for
    it twice, or after resuming, gives the same (docs/adr/0070).

    Parameters
    ----------
    label
        Name for displays.
    tasks
        What it chooses among, as JSON values: saved progress belongs to them.
    total_steps
        Learning steps to train, over all environments.
    seed
        Of everything random in the teacher.
    """

    def __init__(self, *, label: str, tasks: Any, total_steps: int, seed: int) -> None:
        self._label = label
        self._chosen_among = tasks
        self._total_steps = total_steps
        self._seed = seed
        self._steps = 0
        self._draws = Draws(seed)

    @property
    def finished(self) -> bool:
        """Whether the steps are used up."""
        return self._steps >= self._total_steps

    def status(self) -> TeacherStatus:
        """Say where the teacher stands."""
        return TeacherStatus(label=self._label, steps=self._steps, planned_steps=self._total_steps)

    @abstractmethod
    def distribution(self) -> TaskDistribution:
        """Return the distribution from which environments draw their next tasks."""

    def sample(self, k: int = 1) -> FloatArray:
        """Draw tasks, shape ``(k, parameter)``."""
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
        """Take one episode that ended; see :class:`surmount.teachers.teacher.Teacher`."""
        self._steps += length
        self.take(
            EndedEpisode(
                episode_return=float(episode_return),
                length=int(length),
                task=np.asarray(task, dtype=np.float64).reshape(-1),
                progress=float(progress),
                env_id=env_id,
                value_error=None if value_error is None else float(value_error),
            )
        )

    @abstractmethod
    def take(self, episode: EndedEpisode) -> None:
        """Learn from one episode that ended."""

    def update_on_rollout(self, outcome: RolloutOutcome) -> None:
        """Take the episodes of a roll-out in the order in which they ended."""
        episodes, errors = outcome.episodes, outcome.value_errors
        for index in range(episodes.step.size):
            self.take(
                EndedEpisode(
                    episode_return=float(episodes.reward[index]),
                    length=int(episodes.length[index]),
                    task=episodes.variant[index],
                    progress=float(episodes.success[index]),
                    env_id=None,
                    value_error=None if errors is None else float(errors[index]),
                )
            )
        self._steps += outcome.rewards.size

    def state_dict(self) -> dict[str, Any]:
        """Return everything needed to go on, as JSON values."""
        return {
            **belongs_to(self._label, self._chosen_among),
            "steps": self._steps,
            "draws": self._draws.calls,
            **self._state(),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a state returned by :meth:`state_dict`."""
        require_same(state, self._label, self._chosen_among)
        self._steps = int(state["steps"])
        self._draws.calls = int(state["draws"])
        self._load(state)

    @abstractmethod
    def _state(self) -> dict[str, Any]: ...

    @abstractmethod
    def _load(self, state: Mapping[str, Any]) -> None: ...
