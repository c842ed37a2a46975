"""Episodes as they go on: how long, over which paths, and how each of them ends."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.measures import Measures
from surmount.rstar.course.obstacles import Obstacle, surface_m
from surmount.rstar.course.start_poses import start_height_m

_ONE: IntArray = np.array(1)


class Episodes:
    """The present episode of every environment.

    Parameters
    ----------
    num_envs
        Number of environments.
    obstacle, config
        Family; target, fall depth and cap.

    Attributes
    ----------
    variant
        Task of the episode, shape ``(env, parameter)``.
    steps
        Steps taken, shape ``(env,)``.
    path_deg
        Path lengths Σ|Δangle| of FBEM and sprawl (paper III-D), shape ``(2, env)``.
    terminated, truncated, success, diverged
        How the episode ended, if it did, shape ``(env,)``.
    completion_time_s
        Time to the target in s; the cap where it is not reached (paper III-D), shape ``(env,)``.
    interval_s, target_m
        Time between steps in s and position of the target line in m, as arrays of no dimension:
        NumPy takes half as long again for an operation with a number (ADR 41).
    target_point_m
        Where each episode's distance is measured to, in m, shape ``(3, env)``: the middle of the
        target line, at the height that the base has in the start pose above the surface there
        (the floor, unless the line lies on a step), so that a robot in that pose reaches it.
    any_over
        Whether any episode has ended and not begun anew.
    """

    def __init__(self, num_envs: int, obstacle: Obstacle, config: EnvConfig) -> None:
        self._obstacle, self._course = obstacle, config.course
        course = config.course
        self._start_height_m = start_height_m(config)
        self.target_point_m: FloatArray = np.zeros((3, num_envs))
        self.target_point_m[0] = course.target_m
        self.interval_s: FloatArray = np.array(config.step_s)
        self.target_m: FloatArray = np.array(course.target_m)
        self._lowest_m: FloatArray = np.array(-course.fall_depth_m)
        self._cap = config.steps_per_episode
        self._cap_s = config.episode_s
        self.variant: FloatArray = np.zeros((num_envs, 1))
        self.steps: IntArray = np.zeros(num_envs, dtype=np.int64)
        self.path_deg: FloatArray = np.zeros((2, num_envs))
        self.terminated: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self.truncated: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self.success: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self.diverged: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self.completion_time_s: FloatArray = np.full(num_envs, self._cap_s)
        self.any_over = False
        self._steps_left = 0

    def begin(self, envs: IntArray) -> None:
        """Begin an episode in each of ``envs``."""
        self.steps[envs] = 0
        self.path_deg[:, envs] = 0.0
        for flags in (self.terminated, self.truncated, self.success, self.diverged):
            flags[envs] = False
        self._take_stock()

    def go_on(
        self,
        now: Measures,
        change_deg: FloatArray,
        diverged: BoolArray,
        running: BoolArray | None,
    ) -> BoolArray | None:
        """Count a step and judge what it led to.

        Parameters
        ----------
        now
            What is measured after the step.
        change_deg
            Absolute changes of FBEM and sprawl over the step, shape ``(2, env)``; zero where
            the environment was not running.
        diverged
            Simulations that diverged, shape ``(env,)``.
        running
            Environments whose episodes go on, shape ``(env,)``, or None if all do.

        Returns
        -------
        BoolArray or None
            Episodes that ended by this step, shape ``(env,)``; None if no episode did.
        """
        self.path_deg += change_deg
        self.steps += _ONE if running is None else running
        self._steps_left -= 1
        reached = now.x_m >= self.target_m
        fell = now.z_m < self._lowest_m
        ended: BoolArray = reached | fell
        if self._steps_left <= 0:
            ended |= self.steps >= self._cap
        ended |= diverged
        if running is not None:
            ended &= running
        if not np.count_nonzero(ended):
            return None
        self.diverged |= ended & diverged
        self.success |= ended & reached & ~diverged
        self.terminated |= ended & (reached | fell | diverged)
        self.truncated |= ended & ~self.terminated
        self._take_stock()
        return ended

    def park(self, envs: BoolArray) -> None:
        """Cut episodes short, shape ``(env,)``, whatever came of them."""
        self.truncated |= envs & ~self.terminated
        self._take_stock()

    def covered(self, now: Measures) -> FloatArray:
        """Return the share of the way to the target line that was covered, ``(env,)``, 0 to 1.

        The way is the same for all episodes, from the fixed start on: a random start beyond it has
        covered a part already. A base whose simulation diverged, and is nowhere, covered nothing.
        """
        start_m = self._course.fixed_start_m
        covered = (now.x_m - start_m) / (self._course.target_m - start_m)
        return np.nan_to_num(np.clip(covered, 0.0, 1.0), nan=0.0)

    @property
    def over(self) -> BoolArray:
        """Episodes that have ended and not begun anew, shape ``(env,)``."""
        return self.terminated | self.truncated

    def _take_stock(self) -> None:
        """Work out what changes only when episodes begin or end."""
        over = self.over
        self.any_over = bool(over.any())
        self._steps_left = self._cap - int(self.steps[~over].max(initial=0))
        self.completion_time_s = np.where(self.success, self.steps * self.interval_s, self._cap_s)
        surface = surface_m(self._obstacle, self._course, self._course.target_m, self.variant[:, 0])
        self.target_point_m[2] = surface + self._start_height_m

    def state_dict(self) -> dict[str, Any]:
        """Return all that is known of the present episodes, as arrays."""
        return {name: getattr(self, name).copy() for name in _STATE}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from :meth:`state_dict`."""
        for name in _STATE:
            getattr(self, name)[:] = state[name]
        self._take_stock()


_STATE = ("variant", "steps", "path_deg", "terminated", "truncated", "success", "diverged")
