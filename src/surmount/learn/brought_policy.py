"""Policies that were trained elsewhere, tried as if they were Surmount's initial networks.

A policy is a function from one observation to one action, or an object with ``predict`` as models
of Stable-Baselines3 have it: ``predict(observation, state, episode_start, deterministic)`` gives
the actions of all trials at once and the state of its memory.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, cast

import gymnasium
import numpy as np
from stable_baselines3.common.utils import set_random_seed

from surmount.core.errors import InputError, SurmountError, cause
from surmount.core.seeds import derive_seed
from surmount.envs.family import TaskFamily
from surmount.envs.loading import load_function
from surmount.envs.making import called
from surmount.envs.observations import row
from surmount.learn.learner import Acts
from surmount.learn.rollout_config import RolloutConfig
from surmount.learn.rollouts import roll_out
from surmount.trials.trials import Trials
from surmount.workflow.monitor import Monitor


def load_policy(name: str) -> Any:
    """Return the policy that the function of a name returns.

    Parameters
    ----------
    name
        As ``module:function``; the function takes no arguments.

    Raises
    ------
    ConfigError
        If there is no such function.
    InputError
        If its module or the function fails, or it returns no policy.
    """
    policy = called(load_function(name, example="my_module:load"), name)
    if not callable(getattr(policy, "predict", None)) and not callable(policy):
        raise InputError(
            f"`{name}` returned {type(policy).__name__}, not a policy.",
            remedy="Return a function from an observation to an action, or an object with "
            "predict(observation, state, episode_start, deterministic), as models of "
            "Stable-Baselines3 are.",
        )
    return policy


class BroughtActor:
    """Satisfies :class:`surmount.learn.learner.TrialActor`.

    What a policy draws from the generators of Python, NumPy and PyTorch themselves follows from
    the seed.

    Parameters
    ----------
    name
        How errors name the policy.
    policy
        As the module says; one that is both is asked by its ``predict``.
    action_space
        Of a single environment; numbers beyond a box are clipped to it.
    """

    def __init__(self, name: str, policy: Any, action_space: gymnasium.Space[Any]) -> None:
        self._name = name
        self._space = action_space
        self._policy = policy
        self._predicts = callable(getattr(policy, "predict", None))

    def begin(self, trials: int, rng: np.random.Generator, *, deterministic: bool) -> Acts:
        """Begin so many trials at once; a function acts as it does, deterministic or not."""
        set_random_seed(int(rng.integers(2**31)))
        ask = (
            self._by_predict(trials, deterministic) if self._predicts else self._one_by_one(trials)
        )

        def act(observations: Any) -> np.ndarray:
            try:
                given = ask(observations)
            except SurmountError:
                raise
            except Exception as error:
                raise InputError(
                    f"The policy `{self._name}` fails ({cause(error)}).",
                    remedy="Call it by itself with an observation of the environment first: "
                    "Python then shows where it fails.",
                ) from error
            return self._fitting(given, trials)

        return act

    def _one_by_one(self, trials: int) -> Callable[[Any], np.ndarray]:
        def ask(observations: Any) -> np.ndarray:
            own = (row(observations, trial) for trial in range(trials))
            return np.asarray([np.asarray(self._policy(one)) for one in own])

        return ask

    def _by_predict(self, trials: int, deterministic: bool) -> Callable[[Any], np.ndarray]:
        state: Any = None
        starts = np.ones(trials, dtype=np.bool_)

        def ask(observations: Any) -> np.ndarray:
            nonlocal state, starts
            answer = self._policy.predict(observations, state, starts, deterministic)
            if not isinstance(answer, tuple) or len(cast("tuple[Any, ...]", answer)) != 2:
                raise InputError(
                    f"`predict` of the policy `{self._name}` returned {type(answer).__name__}.",
                    remedy="Return the actions and the state, which is None without memory.",
                )
            actions, state = cast("tuple[Any, Any]", answer)
            starts = np.zeros(trials, dtype=np.bool_)
            return np.asarray(actions)

        return ask

    def _fitting(self, given: np.ndarray, trials: int) -> np.ndarray:
        """Return actions as the environments take them, shape ``(trial, ...)``."""
        shape = (trials, *(self._space.shape or ()))
        if given.dtype.kind not in "biuf":
            raise self._unfit(f"{given.dtype} values")
        if given.size != np.prod(shape, dtype=np.int64):
            raise self._unfit(f"values of shape {given.shape} for {trials} observations")
        given = given.reshape(shape)
        if not np.isfinite(given).all():
            raise self._unfit("values that are not finite")
        if isinstance(self._space, gymnasium.spaces.Box):
            return np.clip(given, self._space.low, self._space.high).astype(self._space.dtype)
        actions = given.astype(self._space.dtype)
        wrong = (actions != given).reshape(trials, -1).any(axis=1)
        for action, is_wrong, told in zip(actions, wrong, given, strict=True):
            if is_wrong or not self._space.contains(action):
                raise self._unfit(str(told))
        return actions

    def _unfit(self, what: str) -> InputError:
        return InputError(
            f"The policy `{self._name}` gave {what}; an action is {self._space}.",
            remedy="Return an action of this space for each observation.",
        )


def policy_trials(
    family: TaskFamily,
    settings: Any,
    name: str,
    policy: Any,
    config: RolloutConfig,
    *,
    seed: int,
    monitor: Monitor,
) -> Trials:
    """Try a policy on every variant of a family of tasks, as trials of initial networks are.

    Parameters
    ----------
    family, settings
        Tasks, and their part of the configuration.
    name
        Of the policy; its trials have a seed of their own by it.
    policy
        As :func:`load_policy` returns it.
    config
        Repetitions and kind of action.
    seed
        Of environments and actions.
    monitor
        Shown how many trials have ended.

    Raises
    ------
    InputError
        If the policy fails, or its actions are none of the environment's.
    Interrupted
        If the monitor asked to stop.
    """
    variants = family.space(settings).variants
    env = family.trial_env(settings, len(variants) * config.repetitions)
    try:
        return roll_out(
            env,
            BroughtActor(name, policy, env.single_action_space),
            variants,
            config,
            network=0,
            seed=derive_seed(seed, "rollout", name),
            monitor=monitor,
        )
    finally:
        env.close()


def by_network(parts: Mapping[str, Trials]) -> Trials:
    """Return the trials of several networks as one, under the networks' names."""
    numbered = [
        replace(part, network=np.full(part.n_trials, number, dtype=np.int64))
        for number, part in enumerate(parts.values())
    ]
    return replace(Trials.concatenate(numbered), network_names=tuple(parts))
