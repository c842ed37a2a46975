"""A teacher for thousands of environments at once: tasks by one call, episodes by one call.

For loops that keep all environments in arrays, on a GPU or not: rsl_rl's, mjlab's, Isaac Lab's. It
needs NumPy alone; tensors go in and out by ``.cpu().numpy()`` and ``torch.from_numpy``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.errors import InputError
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.teacher import (
    Episodes,
    LevelTest,
    RolloutOutcome,
    Teacher,
    require_unfinished,
)


class BatchedTeacher:
    """Gives environments their tasks and tells a teacher what came of them.

    Call :meth:`draw` for the environments that are reset, :meth:`step` after every step of all, and
    :meth:`update` after every roll-out.

    Parameters
    ----------
    teacher
        The teacher.
    num_envs
        Environments that learn at once.
    seed
        Of the tasks that are drawn.

    Raises
    ------
    ConfigError
        If the teacher is finished before training begins.
    """

    def __init__(self, teacher: Teacher, num_envs: int, *, seed: int) -> None:
        require_unfinished(teacher)
        self.teacher = teacher
        self._distribution = teacher.distribution()
        self._rng = np.random.default_rng(seed)
        self._steps = 0
        self._tasks: FloatArray = np.full((num_envs, len(self._distribution.parameters)), np.nan)
        self._reward: FloatArray = np.zeros(num_envs)
        self._length = np.zeros(num_envs, dtype=np.int64)
        self._forget()

    @property
    def tasks(self) -> FloatArray:
        """Present task of every environment, shape ``(env, parameter)``; NaN before the first."""
        return self._tasks.copy()

    @property
    def distribution(self) -> TaskDistribution:
        """What tasks are drawn from now."""
        return self._distribution

    def draw(self, env_ids: npt.ArrayLike) -> FloatArray:
        """Draw the tasks of environments that begin an episode, shape ``(env_id, parameter)``.

        Parameters
        ----------
        env_ids
            Their numbers, ``(env_id,)``.
        """
        chosen = np.asarray(env_ids, dtype=np.int64)
        drawn = self._distribution.sample(self._rng, chosen.size)
        self._tasks[chosen] = drawn
        self._reward[chosen] = 0.0
        self._length[chosen] = 0
        return drawn

    def step(self, rewards: npt.ArrayLike, dones: npt.ArrayLike, success: npt.ArrayLike) -> None:
        """Take what one step brought in every environment.

        Call it before :meth:`draw` for the environments whose episodes have ended.

        Parameters
        ----------
        rewards
            Before any normalisation, ``(env,)``; finite.
        dones
            Whether the episode ended with this step, for whatever reason, ``(env,)``.
        success
            Whether it reached its goal; read where it ended, ``(env,)``.

        Raises
        ------
        InputError
            If an argument has another shape or holds what it cannot, or an environment was stepped
            that was never given a task.
        """
        new = self._one_each("rewards", rewards)
        ended = np.flatnonzero(_yes("dones", self._one_each("dones", dones)))
        succeeded = _yes("success", self._one_each("success", success)[ended])
        if not np.isfinite(new).all():
            raise InputError(
                f"`rewards` holds {new[~np.isfinite(new)][0]}.",
                remedy="Give 0 where a simulation diverged, and end its episode.",
            )
        if np.isnan(self._tasks[ended]).any():
            raise InputError(
                "An episode ended in an environment that was given no task.",
                remedy="Call `draw` for all environments before the first step.",
            )
        self._steps += new.size
        self._rewards.append(new)
        self._reward += new
        self._length += 1
        if not ended.size:
            return
        self._ended.append(
            Episodes(
                step=np.full(ended.size, self._steps),
                variant=self._tasks[ended],
                reward=self._reward[ended],
                length=self._length[ended],
                success=succeeded,
                diverged=np.zeros(ended.size, dtype=np.bool_),
            )
        )
        self._reward[ended] = 0.0
        self._length[ended] = 0

    def update(self) -> LevelTest | None:
        """Tell the teacher of the roll-out; from now on tasks come from what it then pushes.

        Returns
        -------
        LevelTest or None
            The test of a level, if one was due.
        """
        rewards = np.concatenate(self._rewards) if self._rewards else np.empty(0)
        outcome = RolloutOutcome(
            rewards=rewards,
            episodes=_joined(self._ended, self._tasks.shape[1]),
            value_errors=None,
            steps_before=self._steps - rewards.size,
        )
        test = self.teacher.update_on_rollout(outcome)
        self._distribution = self.teacher.distribution()
        self._forget()
        return test

    def state_dict(self) -> dict[str, Any]:
        """Return everything needed to go on, between two roll-outs, as JSON values."""
        return {
            "teacher": self.teacher.state_dict(),
            "rng": self._rng.bit_generator.state,
            "steps": self._steps,
            "tasks": self._tasks.tolist(),
            "reward": self._reward.tolist(),
            "length": self._length.tolist(),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state.

        Raises
        ------
        InputError
            If it is of another number of environments, or of another teacher.
        """
        saved, present = len(state["tasks"]), self._length.size
        if saved != present:
            raise InputError(
                f"The saved progress is of {saved} environments, not of {present}.",
                remedy="Resume with as many environments, or load the teacher's part of it alone: "
                "`teacher.load_state_dict(state['teacher'])`.",
            )
        self.teacher.load_state_dict(state["teacher"])
        self._rng.bit_generator.state = state["rng"]
        self._steps = int(state["steps"])
        self._tasks = np.array(state["tasks"], dtype=np.float64)
        self._reward = np.array(state["reward"], dtype=np.float64)
        self._length = np.array(state["length"], dtype=np.int64)
        self._distribution = self.teacher.distribution()

    def _one_each(self, name: str, values: npt.ArrayLike) -> FloatArray:
        """Return a copy of an argument as numbers, ``(env,)``, and refuse other shapes."""
        numbers = np.array(values, dtype=np.float64)
        if numbers.shape != self._length.shape:
            raise InputError(
                f"`{name}` has shape {numbers.shape}, not {self._length.shape}.",
                remedy="Give one number for each environment; of a column, `column[:, 0]`.",
            )
        return numbers

    def _forget(self) -> None:
        self._rewards: list[FloatArray] = []
        self._ended: list[Episodes] = []


def _yes(name: str, values: FloatArray) -> BoolArray:
    """Return which of an argument's numbers say yes, and refuse those that are neither 0 nor 1."""
    neither = (values != 0) & (values != 1)
    if neither.any():
        raise InputError(
            f"`{name}` holds {values[neither][0]:g}, which is neither 0 nor 1.",
            remedy="Give truth values, one for each environment.",
        )
    return values == 1


def _joined(parts: list[Episodes], parameters: int) -> Episodes:
    empty = Episodes(
        step=np.empty(0, dtype=np.int64),
        variant=np.empty((0, parameters)),
        reward=np.empty(0),
        length=np.empty(0, dtype=np.int64),
        success=np.empty(0, dtype=np.bool_),
        diverged=np.empty(0, dtype=np.bool_),
    )
    names = [name for name, values in vars(empty).items() if values is not None]
    return Episodes(
        **{name: np.concatenate([getattr(part, name) for part in (empty, *parts)])
           for name in names}
    )  # fmt: skip
