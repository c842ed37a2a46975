"""The bookkeeping of all teachers: steps, episodes, tasks drawn by hand, saved progress."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.draws import Draws
from surmount.teachers.teacher import LevelTest, RolloutOutcome, TeacherStatus


@dataclass(frozen=True, kw_only=True, eq=False)
class EndedEpisode:
    """What a teacher is told of one episode.

    Attributes
    ----------
    episode_return, length, task, progress, env_id, value_error, covered
        As the arguments of :meth:`surmount.teachers.teacher.Teacher.update_on_episode`.
    """

    episode_return: float
    length: int
    task: FloatArray
    progress: float
    env_id: int | None
    value_error: float | None
    covered: float | None = None

    def require_sound(self, parameters: Sequence[str] | None) -> None:
        """Refuse what no teacher can learn from: it would decide nothing, or the reverse.

        Parameters
        ----------
        parameters
            Names of the task parameters; ``None`` where nobody knows them.

        Raises
        ------
        InputError
            If the task is not one number per parameter, the return or the share covered is not
            finite, the progress is not from 0 to 1, or no decision was made.
        """
        task = self.task.tolist()
        if not all(map(math.isfinite, task)) or len(task) != len(parameters or task):
            raise InputError(
                f"An episode's task is {task}.",
                remedy="Give its task as it was drawn: one finite number per parameter"
                + (f" ({', '.join(parameters)})." if parameters else "."),
            )
        if not math.isfinite(self.episode_return):
            raise self._unsound("return", self.episode_return, _DIVERGED)
        if not 0.0 <= self.progress <= 1.0:
            raise self._unsound("progress", self.progress, _SHARE)
        if self.length < 1:
            raise self._unsound("length", self.length, "Tell of episodes of at least one decision.")
        if self.covered is not None and not math.isfinite(self.covered):
            raise self._unsound("covered share", self.covered, _DIVERGED)

    def _unsound(self, what: str, value: float, remedy: str) -> InputError:
        task = ", ".join(map(str, self.task.tolist()))
        return InputError(f"An episode's {what} is {value} (task {task}).", remedy=remedy)


_DIVERGED = "Leave out episodes that diverged, or give what they had got until then."
_SHARE = "Give 1 where it reached its goal, 0 where it did not, or a share in between."


class BaseTeacher(ABC):
    """A :class:`surmount.teachers.teacher.Teacher` but for what it chooses and when it ends.

    Episodes and roll-outs are told to it in one way, by :meth:`take_steps`, which also counts the
    steps. Its state is what is saved here and what :meth:`_state` adds.

    Parameters
    ----------
    name
        Saved progress belongs to it.
    tasks
        What it chooses among, as JSON values: saved progress belongs to them too.
    draws
        Of :meth:`sample`.
    """

    def __init__(self, *, name: str, tasks: Any, draws: Draws) -> None:
        self._name = name
        self._chosen_among = tasks
        self._steps = 0
        self.draws = draws

    @property
    @abstractmethod
    def finished(self) -> bool:
        """Whether training under this teacher is over."""

    @abstractmethod
    def status(self) -> TeacherStatus:
        """Say where the teacher stands."""

    @abstractmethod
    def distribution(self) -> TaskDistribution:
        """Return the distribution from which environments draw their next tasks."""

    @abstractmethod
    def take_steps(
        self, rewards: FloatArray, ends: IntArray, episodes: Sequence[EndedEpisode]
    ) -> LevelTest | None:
        """Count learning steps and learn from them; return the level test, if one was due.

        Parameters
        ----------
        rewards
            Unnormalised reward of each step, ``(step,)``.
        ends
            At which of these steps episodes ended, from 1, ``(episode,)``.
        episodes
            These episodes.
        """

    def sample(self, k: int = 1) -> FloatArray:
        """Draw ``k`` tasks of :meth:`distribution`, shape ``(k, parameter)``."""
        return self.draws.draw(self.distribution(), k)

    def update_on_episode(
        self,
        episode_return: float,
        length: int,
        task: FloatArray,
        progress: float,
        env_id: int | None = None,
        *,
        value_error: float | None = None,
        covered: float | None = None,
    ) -> None:
        """Take one episode that ended; see :class:`surmount.teachers.teacher.Teacher`.

        Raises
        ------
        InputError
            If nothing can be learnt from it, see :meth:`EndedEpisode.require_sound`.
        """
        episode = EndedEpisode(
            episode_return=float(episode_return),
            length=int(length),
            task=np.asarray(task, dtype=np.float64).reshape(-1),
            progress=float(progress),
            env_id=env_id,
            value_error=None if value_error is None else float(value_error),
            covered=None if covered is None else float(covered),
        )
        self._require_sound([episode])
        rewards = np.full(episode.length, episode.episode_return / episode.length)
        self.take_steps(rewards, np.array([episode.length]), [episode])

    def update_on_rollout(self, outcome: RolloutOutcome) -> LevelTest | None:
        """Take a roll-out, its episodes in the order in which they ended.

        Raises
        ------
        InputError
            If a reward is not finite, or nothing can be learnt from an episode; then nothing is.
        """
        ended, errors = outcome.episodes, outcome.value_errors
        episodes = [
            EndedEpisode(
                episode_return=float(ended.reward[index]),
                length=int(ended.length[index]),
                task=ended.variant[index].reshape(-1),
                progress=float(ended.success[index]),
                env_id=None,
                value_error=None if errors is None else float(errors[index]),
                covered=None if ended.covered is None else float(ended.covered[index]),
            )
            for index in range(ended.step.size)
        ]
        self._require_sound(episodes)
        if not np.isfinite(outcome.rewards).all():
            raise InputError(
                "A reward of the roll-out is not finite.",
                remedy="End an episode before its state is no longer finite, as "
                "`surmount.TaskEnv` does.",
            )
        return self.take_steps(outcome.rewards, ended.step - outcome.steps_before, episodes)

    def state_dict(self) -> dict[str, Any]:
        """Return everything needed to go on, as JSON values."""
        return {
            "teacher": self._name,
            "chooses_among": self._chosen_among,
            "steps": self._steps,
            "draws": self.draws.calls,
            **self._state(),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a state returned by :meth:`state_dict`.

        Raises
        ------
        InputError
            If it was saved by another teacher, or under another curriculum or other tasks.
        """
        other = state.get("teacher", "none that says so")
        if other != self._name:
            raise InputError(
                f"The saved progress belongs to another teacher: {other}, not {self._name}.",
                remedy="Resume with the teacher it was saved under, or start afresh.",
            )
        if state["chooses_among"] != self._chosen_among:
            raise InputError(
                "The saved progress belongs to another curriculum or other tasks.",
                remedy="Resume with the curriculum or the tasks it was saved under, or start "
                "afresh.",
            )
        self._load(state)
        self._steps = int(state["steps"])
        # Not in states from before tasks could be drawn by hand.
        self.draws.calls = int(state.get("draws", self.draws.calls))

    @cached_property
    def _parameters(self) -> tuple[str, ...]:
        return tuple(self.distribution().parameters)

    def _require_sound(self, episodes: Sequence[EndedEpisode]) -> None:
        # A teacher without levels is finished at once and has no distribution.
        parameters = None if self.finished else self._parameters
        for episode in episodes:
            episode.require_sound(parameters)

    @abstractmethod
    def _state(self) -> dict[str, Any]:
        """Return what is to be saved beside steps and draws."""

    @abstractmethod
    def _load(self, state: Mapping[str, Any]) -> None:
        """Take up what :meth:`_state` returned; refuse it before anything is changed."""


class BudgetTeacher(BaseTeacher):
    """A teacher that ends with the first roll-out that reaches a number of learning steps.

    Parameters
    ----------
    label
        Name for displays.
    total_steps
        Learning steps to train, over all environments.
    name, tasks, draws
        As in :class:`BaseTeacher`.
    """

    def __init__(
        self, *, label: str, total_steps: int, name: str, tasks: Any, draws: Draws
    ) -> None:
        super().__init__(name=name, tasks=tasks, draws=draws)
        self._label = label
        self._total_steps = total_steps

    @property
    def finished(self) -> bool:
        """Whether the steps are used up."""
        return self._steps >= self._total_steps

    def status(self) -> TeacherStatus:
        """Say how many of the steps are done."""
        return TeacherStatus(label=self._label, steps=self._steps, planned_steps=self._total_steps)
