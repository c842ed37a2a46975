"""A Gymnasium environment with task parameters: the contract, as a wrapper."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, cast

import gymnasium
import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.axis import AxisKind
from surmount.core.errors import InputError, SurmountError, cause
from surmount.envs.observations import (
    add_task,
    is_finite,
    numbers,
    text_entries,
    with_task,
    without_text,
)
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.space import TaskSpace

EPISODE_SEEDS = 2**31
"""Each episode is reset with a seed of its own below this."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Transition:
    """What is known after a step, or after a reset, to judge success and take features.

    Attributes
    ----------
    env
        The innermost environment.
    observation, reward, terminated, truncated, info
        As the wrapped environment returned them; after a reset the reward is 0.
    """

    env: gymnasium.Env[Any, Any]
    observation: Any
    reward: float
    terminated: bool
    truncated: bool
    info: dict[str, Any]


SetTask = Callable[[gymnasium.Env[Any, Any], dict[str, Any]], None]
"""Gets a ``float``, on an axis of whole numbers an ``int``, of a category the name."""
Feature = str | Callable[[Transition], float]


_PASSED_ON = (SurmountError, TimeoutError)
"""What is said already; an alarm that rings while an environment works is no fault of it."""


class UntoldSuccessError(InputError):
    """Nothing says whether the goal was reached: a key is missing, or neither true nor false."""


class UnusableStartError(InputError):
    """An episode began with an observation that is not finite."""


class TaskEnv(gymnasium.Wrapper[Any, Any, Any, Any]):
    """An environment that draws its task inside ``reset``, and says what became of it.

    The task is set before the wrapped environment is reset, and each episode is reset with a seed
    of its own, so that an episode is a function of its task, its seed and its actions.

    Text in a dictionary of observations is left out: no network reads it. What an observation held
    that ended the episode as diverged is kept as ``unusable``.

    Infos hold ``variant`` (the task), ``is_success``, ``features`` (with the time in seconds
    first) and ``diverged``.

    Parameters
    ----------
    env
        The environment.
    space
        Its task parameters.
    set_task
        Called with the innermost environment and the task by name, before each reset; or the
        key under which ``reset(options=…)`` takes the task by name.
    success
        Whether the goal is reached at a moment; or the key of ``info`` that says so, which must be
        there when an episode ends. True or false, or a number that is 1 or 0.
    features
        What describes behaviour, by name: a number taken at a moment, or a key of ``info``.
    step_s
        Seconds per step; by default the innermost environment's ``dt``, else one over its
        ``render_fps``, else 1.
    end_on_success
        Whether an episode ends when the goal is reached.
    observe_task
        Whether the task, scaled to −1 to 1, is appended to the observation, a category as one
        number for each of its axis' names; integers become floats. In a dictionary it is the
        entry ``task``.

    Raises
    ------
    InputError
        If the contract is incomplete.
    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        *,
        space: TaskSpace,
        set_task: SetTask | str,
        success: str | Callable[[Transition], bool],
        features: Mapping[str, Feature],
        step_s: float | None = None,
        end_on_success: bool = False,
        observe_task: bool = False,
    ) -> None:
        super().__init__(env)
        if not features or "time_s" in features:
            raise InputError(
                "`features` is empty, or holds `time_s`, which is added by itself.",
                remedy="Name at least one number that describes how the task is done.",
            )
        self.task_parameters = space.parameters
        self.feature_names = ("time_s", *features)
        self.step_s = _step_s(env) if step_s is None else float(step_s)
        self._set_task = set_task
        self._success = success
        self._features = dict(features)
        self._end_on_success = end_on_success
        self._observe_task = observe_task
        self._text = text_entries(env.observation_space)
        self._rng = np.random.default_rng()
        self._inner = env.unwrapped
        self._take_space(space)

    def declare_axes(self, kinds: Mapping[str, AxisKind]) -> None:
        """Take task parameters to be of other kinds than the task space says.

        Parameters
        ----------
        kinds
            By parameter, as ``axes`` of :meth:`TaskSpace.grid`.

        Raises
        ------
        InputError
            If there is no such parameter, or its values cannot lie on such an axis.
        """
        self._take_space(self.space.declared(kinds))

    @property
    def task(self) -> FloatArray:
        """Task of the present episode, shape ``(parameter,)``."""
        return self._task.copy()

    @property
    def last_observation(self) -> Any:
        """What the wrapped environment returned last, without an appended task."""
        return self._observation

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        """Draw the tasks of coming episodes from another distribution.

        Raises
        ------
        InputError
            If it is over other parameters, or other axes.
        """
        self.space.require_same(distribution)
        self._distribution = distribution

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode; ``options={"variant": …}`` sets its task instead of drawing it.

        A category is given by its name, or by its place among the names.

        Raises
        ------
        UnusableStartError
            If an observation is not finite: no network can act on it.
        InputError
            If the environment fails, with the task and the seed.
        """
        if seed is not None:
            self._rng = np.random.default_rng(seed)
        rest = dict(options or {})
        chosen = rest.pop("variant", None)
        episode_seed = int(self._rng.integers(EPISODE_SEEDS))
        drawn = self._distribution.sample(self._rng, 1)[0]
        task = drawn if chosen is None else self.space.task(_listed(chosen))
        return self._begin(task, episode_seed, rest)

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Take one step; what is no longer finite ends the episode as diverged.

        Raises
        ------
        UntoldSuccessError
            If the episode ends and ``info`` does not hold the key that tells success, or what
            tells it is neither true nor false.
        InputError
            If the environment fails, with the step, the task and the seed.
        """
        number = len(self._actions) + 1
        try:
            return self._step(action)
        except _PASSED_ON:
            raise
        except Exception as error:
            raise self._failure(f"`step` {number}", error) from error

    def _step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        observation, reward, terminated, truncated, info = self.env.step(action)
        self._actions.append(np.array(action))
        reward = _one_number(reward, "The reward")
        diverged = not (math.isfinite(reward) and is_finite(observation))
        if diverged:
            self.unusable = observation
            observation, reward, terminated = self._observation, 0.0, True
        transition = Transition(
            env=self._inner,
            observation=observation,
            reward=reward,
            terminated=bool(terminated),
            truncated=bool(truncated),
            info=info,
        )
        found = self._judged(transition, diverged=diverged)
        terminated = bool(terminated) or (self._end_on_success and found["is_success"])
        self._observation = observation
        return self._seen(observation), reward, terminated, bool(truncated), {**info, **found}

    def state_dict(self) -> dict[str, Any]:
        """Return what leads back to this moment: task, seed and actions of the episode."""
        shape = self.action_space.shape or ()
        return {
            "rng": self._rng.bit_generator.state,
            "distribution": dict(self._distribution.to_record()),
            "task": self._task.copy(),
            "seed": self._episode_seed,
            "actions": np.array(self._actions).reshape(len(self._actions), *shape),
            "observation": numbers(self._observation),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> bool:
        """Go back to a saved moment by taking the episode's steps again.

        Returns
        -------
        bool
            Whether the environment came to the same observation, bit by bit.
        """
        self._rng.bit_generator.state = state["rng"]
        self._distribution = TaskDistribution.from_record(state["distribution"])
        self._begin(np.array(state["task"], dtype=np.float64), int(state["seed"]), {})
        for action in state["actions"]:
            self.step(action)
        return bool(np.array_equal(numbers(self._observation), state["observation"]))

    def _begin(
        self, task: FloatArray, episode_seed: int, options: dict[str, Any]
    ) -> tuple[Any, dict[str, Any]]:
        self._begin_record(task, episode_seed)
        try:
            return self._reset(task, episode_seed, options)
        except _PASSED_ON:
            raise
        except Exception as error:
            raise self._failure("`reset`", error) from error

    def _reset(
        self, task: FloatArray, episode_seed: int, options: dict[str, Any]
    ) -> tuple[Any, dict[str, Any]]:
        named = self.space.named(task)
        if callable(self._set_task):
            self._set_task(self.env.unwrapped, named)
        else:
            options = {**options, self._set_task: named}
        observation, info = self.env.reset(seed=episode_seed, options=options or None)
        self._inner = self.env.unwrapped  # a wrapper may have chosen another one for the task
        self._observation = observation
        if not is_finite(observation):
            raise self._unusable_start(numbers(observation))
        transition = Transition(
            env=self._inner,
            observation=observation,
            reward=0.0,
            terminated=False,
            truncated=False,
            info=info,
        )
        return self._seen(observation), {**info, **self._judged(transition, diverged=False)}

    def _failure(self, where: str, error: Exception) -> InputError:
        return InputError(
            f"The environment fails in {where} on task {self.space.described(self._task)}, seed "
            f"{self._episode_seed} ({cause(error)}).",
            remedy="Correct what it says; reset and step must not fail on any task.",
        )

    def _unusable_start(self, observed: FloatArray) -> UnusableStartError:
        places = np.flatnonzero(~np.isfinite(observed))
        return UnusableStartError(
            f"After `reset`, observation {places[0]} is {observed[places[0]]} on task "
            f"{self.space.described(self._task)}"
            + (f", and {places.size - 1} more are not finite." if places.size > 1 else "."),
            remedy="Let every observation be finite: clip what may be infinite, as a range "
            "sensor without an echo is, to its range in an ObservationWrapper, as in "
            "np.clip(observation, low, high).",
        )

    def _take_space(self, space: TaskSpace) -> None:
        self.space = space
        self.task_axes = space.axes
        self.observation_space = without_text(self.env.observation_space)
        if self._observe_task:
            observed = sum(axis.observed_size for axis in space.axes)
            self.observation_space = with_task(self.observation_space, observed)
        self._distribution = space.whole_range
        self._begin_record(space.variants[0], 0)

    def _begin_record(self, task: FloatArray, episode_seed: int) -> None:
        self._task = np.array(task, dtype=np.float64)
        self._place = self._observed_task()
        self._episode_seed = episode_seed
        self._actions: list[Any] = []
        self._observation: Any = None
        self.unusable: Any = None

    def _judged(self, transition: Transition, *, diverged: bool) -> dict[str, Any]:
        reached = not diverged and self._reached(transition)
        values = [len(self._actions) * self.step_s]
        for name, feature in self._features.items():
            if callable(feature):
                values.append(_one_number(feature(transition), f"The feature `{name}`"))
            elif feature in transition.info:
                values.append(_one_number(transition.info[feature], f"The feature `{name}`"))
            else:
                raise InputError(
                    f"The feature `{name}` is `info[{feature!r}]`, which is not there.",
                    remedy="Let `info` hold it after every reset and step, or give a function.",
                )
        return {
            "variant": self._task.copy(),
            "is_success": reached,
            "diverged": diverged,
            "features": np.array(values),
        }

    def _reached(self, transition: Transition) -> bool:
        success = self._success
        if not isinstance(success, str):
            return _true_or_false(success(transition), "What `success` returns", "share")
        told = transition.info.get(success)
        if told is None and not (transition.terminated or transition.truncated):
            return False
        if told is None:
            raise UntoldSuccessError(
                f"`info` holds no `{success}` when an episode ends.",
                remedy=f"Let the environment put `{success}` into `info`, or give a function as "
                "`success`.",
            )
        return _true_or_false(told, f"`info[{success!r}]`", f't.info["{success}"]')

    def _seen(self, observation: Any) -> Any:
        if self._text:
            observation = {k: part for k, part in observation.items() if k not in self._text}
        if self._place is None:
            return observation
        return add_task(observation, self._place, self.observation_space)

    def _observed_task(self) -> FloatArray | None:
        """Return the task as a network can read it; ``None`` where it is not observed."""
        if not self._observe_task:
            return None
        space = self.space
        ends = zip(space.axes, self._task, space.lower, space.upper, strict=True)
        return np.array([number for axis, *place in ends for number in axis.observed(*place)])


def _one_number(value: Any, called: str) -> float:
    """Return a number, or the one number of an array.

    Raises
    ------
    InputError
        If it is none, or several.
    """
    try:
        return float(value)
    except (TypeError, ValueError):
        if isinstance(value, np.ndarray | list | tuple):
            numbers_in = np.asarray(value, dtype=object).reshape(-1)
            if numbers_in.size == 1:
                return _one_number(numbers_in[0], called)
        raise InputError(
            f"{called} is {value!r}, not one number.",
            remedy="Let it be a number at every moment; of an array say which entry.",
        ) from None


def _true_or_false(told: Any, called: str, share: str) -> bool:
    """Return whether success was told; ``called`` and ``share`` are words for the error.

    Raises
    ------
    UntoldSuccessError
        If it is neither true nor false, nor one number that is 1 or 0.
    """
    if isinstance(told, bool | np.bool_):  # nearly always, and at every step
        return bool(told)
    number = np.asarray(told)
    if number.dtype.kind in "biuf" and number.size == 1 and number.item() in (0, 1):
        return bool(number.item())
    raise UntoldSuccessError(
        f"{called} is {told!r}, which is neither true nor false.",
        remedy=f"Say from where on a share is success, as in `success=lambda t: {share} >= 1`.",
    )


def _listed(variant: Any) -> list[Any]:
    """Return a variant, given as a list, an array or a single value, as its values."""
    if isinstance(variant, list | tuple):
        return list(cast("list[Any]", variant))
    return np.asarray(variant).reshape(-1).tolist()


def _step_s(env: gymnasium.Env[Any, Any]) -> float:
    inner: Any = env.unwrapped
    if isinstance(getattr(inner, "dt", None), int | float):
        return float(inner.dt)
    rate = inner.metadata.get("render_fps")
    return 1.0 / float(rate) if rate else 1.0
