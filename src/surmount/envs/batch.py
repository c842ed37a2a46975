"""Many environments of one's own as one vector environment of the learner."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.envs.observations import require_usual, stacked
from surmount.envs.task_env import TaskEnv
from surmount.tasks.distribution import TaskDistribution

KEYS = ("variant", "is_success", "diverged", "features")


class TaskBatch:
    """Satisfies :class:`surmount.envs.TaskVectorEnv` for environments stepped one by one.

    Parameters
    ----------
    make_env
        Makes one environment.
    num_envs
        How many to make.
    autoreset
        Whether an environment is reset in the step in which its episode ended; otherwise it stays
        as it is.

    Raises
    ------
    InputError
        If observations or actions are of a kind that no learner takes.
    """

    render_mode: str | None = None

    def __init__(
        self, make_env: Callable[[], TaskEnv], num_envs: int, *, autoreset: bool = True
    ) -> None:
        self.envs = [make_env() for _ in range(num_envs)]
        self.num_envs = num_envs
        first = self.envs[0]
        self.task_parameters = first.task_parameters
        self.task_axes = first.task_axes
        self.feature_names = first.feature_names
        self.step_s = first.step_s
        self.single_observation_space = first.observation_space
        self.single_action_space = first.action_space
        require_usual(first.observation_space, first.action_space)
        self._autoreset = autoreset
        self._over: BoolArray = np.zeros(num_envs, dtype=np.bool_)
        self._observations: list[Any] = [None] * num_envs
        self._infos: list[dict[str, Any]] = [{}] * num_envs

    def set_task_distribution(self, distribution: TaskDistribution) -> None:
        """Draw the tasks of coming episodes from another distribution."""
        for env in self.envs:
            env.set_task_distribution(distribution)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode in every environment; ``variant`` holds one task per environment."""
        seeds: list[int | None] = [None] * self.num_envs
        if seed is not None:
            spawned = np.random.SeedSequence(seed).spawn(self.num_envs)
            seeds = [int(one.generate_state(1)[0]) for one in spawned]
        rest = dict(options or {})
        variants = rest.pop("variant", None)
        for index, env in enumerate(self.envs):
            own = rest if variants is None else {**rest, "variant": variants[index]}
            begun = env.reset(seed=seeds[index], options=own)
            self._observations[index], self._infos[index] = begun
        self._over[:] = False
        return self._stacked(), self._told()

    def step(self, actions: Any) -> tuple[Any, FloatArray, BoolArray, BoolArray, dict[str, Any]]:
        """Take one step in every environment whose episode is not over."""
        rewards = np.zeros(self.num_envs)
        terminated = np.zeros(self.num_envs, dtype=np.bool_)
        truncated = np.zeros(self.num_envs, dtype=np.bool_)
        for index in np.flatnonzero(~self._over):
            observation, reward, ended, cut, info = self.envs[index].step(actions[index])
            self._observations[index], self._infos[index] = observation, info
            rewards[index], terminated[index], truncated[index] = reward, ended, cut
        done = terminated | truncated
        if not self._autoreset:
            self._over |= done
            return self._stacked(), rewards, terminated, truncated, self._told()
        infos: dict[str, Any] = {}
        if done.any():
            infos = {"final_obs": self._stacked(), "final_info": self._told()}
            for index in np.flatnonzero(done):
                self._observations[index], self._infos[index] = self.envs[index].reset()
        return self._stacked(), rewards, terminated, truncated, {**self._told(), **infos}

    def state_dict(self) -> dict[str, Any]:
        """Return the state of every environment: its episode's task, seed and actions."""
        return {f"env-{index}": env.state_dict() for index, env in enumerate(self.envs)}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go back to a saved state by taking the steps of unfinished episodes again.

        An environment that does not come to where it was is warned of: it holds something that
        neither its seed nor its actions tell.
        """
        for index, env in enumerate(self.envs):
            if not env.load_state_dict(state[f"env-{index}"]):
                warnings.warn(
                    "An environment took the same steps with the same seed and came elsewhere: "
                    "training goes on, but not as it would have without interruption. Check it "
                    "with `surmount check`.",
                    stacklevel=2,
                )

    def close(self) -> None:
        """Close every environment."""
        for env in self.envs:
            env.close()

    def _stacked(self) -> Any:
        return stacked(self._observations, self.single_observation_space)

    def _told(self) -> dict[str, Any]:
        return {key: np.array([info[key] for info in self._infos]) for key in KEYS}
