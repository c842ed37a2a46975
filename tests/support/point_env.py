"""A small task family for tests of learning: drive a point along a line to a distance.

The state is exact and cheap, so that tests of the learner, of checkpoints and of roll-outs do not
depend on a physics engine. The task parameter is the distance to drive.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np

from surmount.tasks.distribution import TaskDistribution

STEP = 0.2
TOLERANCE = 0.15
MAX_STEPS = 40


class PointEnv:
    """Satisfies ``surmount.envs.TaskVectorEnv``; ``autoreset=False`` freezes ended trials."""

    task_parameters = ("distance_m",)
    feature_names = ("time_s", "position_m")
    step_s = 0.05
    render_mode = None

    def __init__(self, num_envs: int, *, autoreset: bool = True) -> None:
        self.num_envs = num_envs
        self.autoreset = autoreset
        self.single_observation_space = gymnasium.spaces.Box(-10, 10, (2,), np.float32)
        self.single_action_space = gymnasium.spaces.Box(-1, 1, (1,), np.float32)
        self._distribution = TaskDistribution.uniform(
            ("distance_m",), np.array([0.5]), np.array([3.0])
        )
        self._rngs = [np.random.default_rng(index) for index in range(num_envs)]
        self._position = np.zeros(num_envs)
        self._goal = np.zeros(num_envs)
        self._age = np.zeros(num_envs, dtype=np.int64)
        self._done = np.zeros(num_envs, dtype=np.bool_)

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        self._distribution = distribution

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        if seed is not None:
            sequences = np.random.SeedSequence(seed).spawn(self.num_envs)
            self._rngs = [np.random.default_rng(sequence) for sequence in sequences]
        for index in range(self.num_envs):
            self._begin(index)
        if options and "variant" in options:
            self._goal[:] = np.asarray(options["variant"]).reshape(-1)
        return self._observe(), self._infos()

    def step(self, actions: Any):
        live = ~self._done
        self._position[live] += STEP * np.clip(np.asarray(actions)[live, 0], -1, 1)
        self._age[live] += 1
        gap = np.abs(self._goal - self._position)
        terminated = live & (gap < TOLERANCE)
        truncated = live & ~terminated & (self._age >= MAX_STEPS)
        rewards = np.where(live, np.where(terminated, 5.0, -0.1 * gap), 0.0)
        infos = self._infos(terminated)
        done = terminated | truncated
        if self.autoreset:
            if done.any():
                infos |= {"final_info": self._infos(terminated), "final_obs": self._observe()}
            for index in np.flatnonzero(done):
                self._begin(int(index))
        else:
            self._done |= done
        return self._observe(), rewards, terminated, truncated, infos

    def state_dict(self) -> dict[str, Any]:
        return {
            "position": self._position.copy(),
            "goal": self._goal.copy(),
            "age": self._age.copy(),
            "rngs": [rng.bit_generator.state for rng in self._rngs],
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        self._position = np.array(state["position"])
        self._goal = np.array(state["goal"])
        self._age = np.array(state["age"])
        for rng, saved in zip(self._rngs, state["rngs"], strict=True):
            rng.bit_generator.state = saved

    def close(self) -> None:
        pass

    def _begin(self, index: int) -> None:
        self._position[index] = 0.0
        self._goal[index] = self._distribution.sample(self._rngs[index], 1)[0, 0]
        self._age[index] = 0
        self._done[index] = False

    def _observe(self) -> np.ndarray:
        return np.stack([self._position, self._goal], axis=1).astype(np.float32)

    def _infos(self, success: np.ndarray | None = None) -> dict[str, Any]:
        return {
            "variant": self._goal[:, None].copy(),
            "is_success": np.zeros(self.num_envs, np.bool_) if success is None else success.copy(),
            "diverged": np.zeros(self.num_envs, np.bool_),
            "features": np.stack([0.05 * self._age, self._position], axis=1),
        }
