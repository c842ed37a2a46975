"""Many point masses at once as a vector environment of the learner."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.suite.point_mass import (
    EPISODE_STEPS,
    GOAL_DISTANCE,
    LOWER,
    PHYSICS_STEP_S,
    PHYSICS_STEPS,
    START,
    STRONGEST_ACTION,
    SUCCESS_DISTANCE,
    UPPER,
    WALL,
    distance_to_goal,
    push,
    rewards,
)
from surmount.tasks.distribution import TaskDistribution

PARAMETERS = ("gate_position", "gate_width")
"""Names of the task parameters; the publication's plane has no unit."""
STEP_S = PHYSICS_STEP_S * PHYSICS_STEPS


class PointMassVectorEnv:
    """Satisfies :class:`surmount.envs.vector_env.TaskVectorEnv`, all masses in one array.

    Observations are x, its velocity, y, its velocity, and the gate's position and width. All draw
    from one stream of random numbers, so an episode depends on how many there are.

    Parameters
    ----------
    num_envs
        How many.
    autoreset
        Whether an episode begins anew in the step in which it ended; otherwise the mass stays.
    """

    task_parameters: tuple[str, ...] = PARAMETERS
    feature_names: tuple[str, ...] = ("time_s", "x", "y", "distance")
    step_s: float = STEP_S
    render_mode: str | None = None

    def __init__(self, num_envs: int, *, autoreset: bool = True) -> None:
        self.num_envs = num_envs
        bound = np.array([WALL, np.inf, WALL, np.inf, UPPER[0], UPPER[1]], dtype=np.float32)
        self.single_observation_space = Box(-bound, bound, dtype=np.float32)
        self.single_action_space = Box(
            -STRONGEST_ACTION, STRONGEST_ACTION, shape=(2,), dtype=np.float32
        )
        self._autoreset = autoreset
        self._rng = np.random.default_rng(0)
        self._distribution = TaskDistribution.uniform(PARAMETERS, np.array(LOWER), np.array(UPPER))
        self._state: FloatArray = np.tile(START, (num_envs, 1))
        self._task: FloatArray = np.zeros((num_envs, 2))
        self._steps: IntArray = np.zeros(num_envs, dtype=np.int64)
        self._over: BoolArray = np.zeros(num_envs, dtype=np.bool_)

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        """Draw the tasks of coming episodes from another distribution."""
        if distribution.parameters != PARAMETERS:
            raise InputError(
                f"The task distribution is over {distribution.parameters}, the environment's "
                f"parameters are {PARAMETERS}.",
                remedy="Push a distribution made for the point mass.",
            )
        self._distribution = distribution

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begin an episode in every environment; ``variant`` holds one task per environment."""
        if seed is not None:
            self._rng = np.random.default_rng(seed)
        everything = np.arange(self.num_envs)
        given = None if options is None else options.get("variant")
        self._begin(everything, given)
        return self._observe(), self._told()

    def step(
        self, actions: Any
    ) -> tuple[FloatArray, FloatArray, BoolArray, BoolArray, dict[str, Any]]:
        """Hold actions of shape ``(env, 2)`` for a step in every environment still under way."""
        running = ~self._over
        moved, crashed = push(
            self._state, np.asarray(actions, dtype=np.float64), self._task, self._rng
        )
        self._state = np.where(running[:, None], moved, self._state)
        self._steps += running
        reward = np.where(running, rewards(distance_to_goal(self._state)), 0.0)
        terminated: BoolArray = crashed & running
        truncated: BoolArray = running & ~terminated & (self._steps >= EPISODE_STEPS)
        done = terminated | truncated
        if not self._autoreset:
            self._over |= done
            return self._observe(), reward, terminated, truncated, self._told()
        ended: dict[str, Any] = {}
        if done.any():
            ended = {"final_obs": self._observe(), "final_info": self._told()}
            self._begin(np.flatnonzero(done), None)
        return self._observe(), reward, terminated, truncated, {**self._told(), **ended}

    def state_dict(self) -> dict[str, Any]:
        """Return everything needed to go on bit-identically."""
        return {
            "state": self._state.copy(),
            "task": self._task.copy(),
            "steps": self._steps.copy(),
            "over": self._over.copy(),
            "generator": self._rng.bit_generator.state,
            "task_distribution": dict(self._distribution.to_record()),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        self._state = np.array(state["state"], dtype=np.float64)
        self._task = np.array(state["task"], dtype=np.float64)
        self._steps = np.array(state["steps"], dtype=np.int64)
        self._over = np.array(state["over"], dtype=np.bool_)
        self._rng.bit_generator.state = state["generator"]
        self._distribution = TaskDistribution.from_record(state["task_distribution"])

    def close(self) -> None:
        """Release nothing: all is memory."""

    def _begin(self, envs: IntArray, tasks: Any) -> None:
        drawn = self._distribution.sample(self._rng, envs.size) if tasks is None else tasks
        self._task[envs] = np.asarray(drawn, dtype=np.float64).reshape(envs.size, 2)
        self._state[envs] = START
        self._steps[envs] = 0
        self._over[envs] = False

    def _observe(self) -> FloatArray:
        return np.concatenate([self._state, self._task], axis=1)

    def _told(self) -> dict[str, Any]:
        distance = distance_to_goal(self._state)
        return {
            "variant": self._task.copy(),
            "is_success": distance < SUCCESS_DISTANCE,
            "diverged": np.zeros(self.num_envs, dtype=np.bool_),
            "covered": np.clip(1.0 - distance / GOAL_DISTANCE, 0.0, 1.0),
            "features": np.column_stack(
                [self._steps * STEP_S, self._state[:, 0], self._state[:, 2], distance]
            ),
        }
