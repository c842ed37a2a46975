"""Anybody's environment, made by a function, as a family of tasks."""

from __future__ import annotations

import hashlib
import inspect
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from surmount.envs.batch import TaskBatch
from surmount.envs.family import TaskFamily
from surmount.envs.making import make_task_env, time_limit
from surmount.envs.own_settings import OwnSettings
from surmount.envs.task_env import TaskEnv
from surmount.tasks.space import TaskSpace


class OwnFamily(TaskFamily):
    """The family of an environment with task parameters.

    Parameters
    ----------
    name
        Under which it was found.
    make_env
        Makes one environment.
    """

    settings = OwnSettings

    def __init__(self, name: str, make_env: Callable[[], TaskEnv]) -> None:
        self.name = name
        self.title = name
        self._make_env = make_env

    def space(self, settings: Any) -> TaskSpace:
        """Return the task space of the environment."""
        env = self.make(settings)
        env.close()
        return env.space

    def fingerprint(self, settings: Any) -> str:
        """Return the SHA-256 of the file of the function's module, in hexadecimal.

        Modules that it imports are not part of it.
        """
        del settings
        function = inspect.unwrap(self._make_env)
        try:
            source = inspect.getfile(function)
        except TypeError:  # an object that is called, such as a partial function
            module = self.name.rpartition(":")[0] or type(self._make_env).__module__
            source = inspect.getfile(sys.modules[module])
        return hashlib.sha256(Path(source).read_bytes()).hexdigest()

    def cap_s(self, settings: Any) -> float:
        """Return the time limit of the environment in s.

        Raises
        ------
        ConfigError
            If there is none.
        """
        del settings
        env = self.make()
        env.close()
        return time_limit(env) * env.step_s

    def training_env(self, settings: Any, num_envs: int) -> TaskBatch:
        """Build environments that begin anew when an episode ends."""
        return TaskBatch(lambda: self.make(settings), num_envs)

    def trial_env(self, settings: Any, num_envs: int) -> TaskBatch:
        """Build environments that stay as they are when an episode ends."""
        return TaskBatch(lambda: self.make(settings), num_envs, autoreset=False)

    def make(self, settings: Any = None) -> TaskEnv:
        """Make one environment, with the kinds of axes that its settings declare.

        Raises
        ------
        InputError
            If the function needs arguments, fails, or returns no :class:`TaskEnv`, or its
            parameters cannot be what the settings say.
        """
        env = make_task_env(self._make_env)
        if isinstance(settings, OwnSettings) and settings.kinds:
            env.declare_axes(settings.kinds)
        return env
