"""A vector environment as Stable-Baselines3 sees it, and the record of what happens in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

import gymnasium
import numpy as np
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvObs

from surmount.envs.vector_env import Infos, TaskVectorEnv
from surmount.learn.episode_recorder import EpisodeRecorder
from surmount.teachers.teacher import RolloutOutcome


class Recorder(VecEnv):
    """A :class:`TaskVectorEnv` as Stable-Baselines3 sees it, keeping what teachers are told.

    Rewards are recorded here, before any normalisation, and so are the episodes that end.
    """

    def __init__(self, env: TaskVectorEnv) -> None:
        self.env = env
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)
        self._actions = np.empty(0)
        self._record = EpisodeRecorder(env.num_envs, len(env.task_parameters))

    @property
    def steps(self) -> int:
        """Learning steps so far, over all environments."""
        return self._record.steps

    def reset(self) -> VecEnvObs:
        """Begin an episode in every environment, with the seed last given."""
        observations, _ = self.env.reset(seed=self._seeds[0])
        self._reset_seeds()
        self._record.begin_all()
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        """Keep the actions for :meth:`step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[VecEnvObs, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Take one step in every environment and record what came of it."""
        observations, rewards, terminated, truncated, infos = self.env.step(self._actions)
        done = terminated | truncated
        self._record.add(rewards)
        sb3_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for index in np.flatnonzero(done):
            sb3_infos[index] = self._end_episode(int(index), bool(terminated[index]), infos)
        return observations, rewards.astype(np.float32), done, sb3_infos

    def collect(self, advantages: np.ndarray | None = None) -> RolloutOutcome:
        """Return what was recorded since the last call; see :class:`EpisodeRecorder`."""
        return self._record.collect(advantages)

    def state_dict(self) -> dict[str, Any]:
        """Return the environments' state and that of the record."""
        return {"env": self.env.state_dict(), **self._record.state_dict()}

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        self.env.load_state_dict(state["env"])
        self._record.load_state_dict(state)

    def close(self) -> None:
        """Release resources."""
        self.env.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of the vector environment, once per environment asked for."""
        return [getattr(self.env, attr_name) for _ in self._chosen(indices)]

    def set_attr(
        self,
        attr_name: str,
        value: Any,
        indices: VecEnvIndices = None,  # noqa: ARG002 - one batch has one value
    ) -> None:
        """Set an attribute of the vector environment."""
        setattr(self.env, attr_name, value)

    def env_method(
        self,
        method_name: str,
        *method_args: Any,
        indices: VecEnvIndices = None,
        **method_kwargs: Any,
    ) -> list[Any]:
        """Call a method of the vector environment once."""
        result = getattr(self.env, method_name)(*method_args, **method_kwargs)
        return [result for _ in self._chosen(indices)]

    def env_is_wrapped(
        self,
        wrapper_class: type[gymnasium.Wrapper[Any, Any, Any, Any]],  # noqa: ARG002
        indices: VecEnvIndices = None,
    ) -> list[bool]:
        """Return false: a batched environment has no wrappers of single environments."""
        return [False for _ in self._chosen(indices)]

    def _chosen(self, indices: VecEnvIndices) -> Sequence[int]:
        return cast("Sequence[int]", list(self._get_indices(indices)))

    def _end_episode(self, index: int, terminated: bool, infos: Infos) -> dict[str, Any]:
        final: Infos = infos["final_info"]
        episode = self._record.end(
            index,
            variant=final["variant"][index],
            success=bool(final["is_success"][index]),
            diverged=bool(final["diverged"][index]),
            covered=float(final["covered"][index]) if "covered" in final else None,
        )
        return {
            "terminal_observation": infos["final_obs"][index],
            "TimeLimit.truncated": not terminated,
            "is_success": episode["success"],
            "episode": {"r": episode["reward"], "l": episode["length"], "t": 0.0},
        }
