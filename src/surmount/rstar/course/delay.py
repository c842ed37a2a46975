"""Actions that take effect some steps after they were decided."""

from __future__ import annotations

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray


class DelayLine:
    """The last actions of every environment, on their way to the servos.

    Parameters
    ----------
    num_envs, n_actions
        Number of environments and of entries of an action.
    longest
        Longest delay in steps.

    Attributes
    ----------
    waiting
        Last actions, shape ``(env, longest + 1, action)``, the newest first.
    steps
        Delay of each environment's present episode, shape ``(env,)``.
    """

    def __init__(self, num_envs: int, n_actions: int, longest: int) -> None:
        self.waiting: FloatArray = np.zeros((num_envs, longest + 1, n_actions))
        self.steps: IntArray = np.zeros(num_envs, dtype=np.int64)
        self._envs: IntArray = np.arange(num_envs)

    def begin(self, env: int, steps: int) -> None:
        """Forget an environment's actions and set its delay: until one arrives, zero is passed."""
        self.waiting[env] = 0.0
        self.steps[env] = steps

    def pass_on(self, actions: FloatArray, running: BoolArray | None) -> FloatArray:
        """Take the actions decided now and return those that take effect now, ``(env, action)``.

        Environments that are not ``running`` (None: all are) keep what is waiting.
        """
        chosen = slice(None) if running is None else running
        self.waiting[chosen] = np.concatenate(
            [actions[chosen, None], self.waiting[chosen, :-1]], axis=1
        )
        return self.waiting[self._envs, self.steps]
