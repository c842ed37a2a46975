"""Making one's own environment: what its function must return, and how long episodes may be."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import gymnasium

from surmount.core.errors import ConfigError, InputError, SurmountError, cause
from surmount.envs.task_env import TaskEnv


def make_task_env(make_env: Callable[[], object]) -> TaskEnv:
    """Call the function that makes an environment.

    Raises
    ------
    InputError
        If the function needs arguments, fails, ends Python, or returns no :class:`TaskEnv`.
    SurmountError
        If the function raises one: it is handed on.
    """
    name = getattr(make_env, "__name__", "make_env")
    env = called(make_env, name)
    if not isinstance(env, TaskEnv):
        raise InputError(
            f"`{name}` returned {type(env).__name__}, not a TaskEnv.",
            remedy="Return surmount.TaskEnv(env, space=…, set_task=…, success=…, features=…).",
        )
    return env


def called(function: Callable[[], object], name: str) -> object:
    """Return what a function of somebody's own returns.

    Raises
    ------
    InputError
        If the function needs arguments, fails, or ends Python.
    SurmountError
        If the function raises one: it is handed on.
    """
    needed = _needed(function)
    if needed:
        raise InputError(
            f"`{name}` needs arguments: {', '.join(needed)}.",
            remedy="Give each a default, or write a function without arguments that calls it.",
        )
    try:
        return function()
    except SurmountError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError(
            f"`{name}` fails ({cause(error)}).",
            remedy="Call it by itself first: Python then shows where it fails.",
        ) from error


def time_limit(env: TaskEnv) -> int:
    """Return the steps after which an episode is cut off.

    The shortest ``gymnasium.wrappers.TimeLimit`` around the environment counts, else the
    ``max_episode_steps`` of its registration.

    Raises
    ------
    ConfigError
        If there is none.
    """
    limits: list[int] = []
    layer: gymnasium.Env[Any, Any] = env
    while isinstance(layer, gymnasium.Wrapper):
        if isinstance(layer, gymnasium.wrappers.TimeLimit):
            limits.append(layer.get_wrapper_attr("_max_episode_steps"))
        layer = layer.env
    if limits:
        return min(limits)
    registered = env.spec.max_episode_steps if env.spec is not None else None
    if registered is None or registered <= 0:
        raise ConfigError(
            "The environment has no time limit.",
            remedy="Wrap it in gymnasium.wrappers.TimeLimit, or give `max_episode_steps` to "
            "gymnasium.make.",
        )
    return registered


def _needed(function: Callable[[], object]) -> list[str]:
    """Return the names of parameters without a default."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):  # some that are written in C have none
        return []
    return [
        one.name
        for one in parameters
        if one.default is one.empty and one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD)
    ]
