"""A vector environment as Stable-Baselines3 sees it, and the record of what happens in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

import gymnasium
import numpy as np
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvObs

from surmount.core.arrays import FloatArray
from surmount.envs.vector_env import Infos, TaskVectorEnv
from surmount.learn.value_errors import EpisodeErrors
from surmount.teachers.teacher import Episodes, RolloutOutcome


class Recorder(VecEnv):
    """A :class:`TaskVectorEnv` as Stable-Baselines3 sees it, keeping what teachers are told.

    Rewards are recorded here, before any normalisation, and so are the episodes that end.
    """

    def __init__(self, env: TaskVectorEnv) -> None:
        self.env = env
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)
        self.steps = 0
        self._actions = np.empty(0)
        self._episode_reward = np.zeros(env.num_envs)
        self._episode_length = np.zeros(env.num_envs, dtype=np.int64)
        self._errors = EpisodeErrors(env.num_envs)
        self._forget()

    def reset(self) -> VecEnvObs:
        """Begin an episode in every environment, with the seed last given."""
        observations, _ = self.env.reset(seed=self._seeds[0])
        self._reset_seeds()
        self._episode_reward[:] = 0.0
        self._episode_length[:] = 0
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        """Keep the actions for :meth:`step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[VecEnvObs, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Take one decision in every environment and record what came of it."""
        observations, rewards, terminated, truncated, infos = self.env.step(self._actions)
        done = terminated | truncated
        self.steps += self.num_envs
        self._rewards.append(np.array(rewards, dtype=np.float64))
        self._episode_reward += rewards
        self._episode_length += 1
        sb3_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for index in np.flatnonzero(done):
            sb3_infos[index] = self._end_episode(int(index), bool(terminated[index]), infos)
        return observations, rewards.astype(np.float32), done, sb3_infos

    def collect(self, advantages: np.ndarray | None = None) -> RolloutOutcome:
        """Return what was recorded since the last call, and forget it.

        Parameters
        ----------
        advantages
            Of all decisions since then, ``(step, env)``, where the learner has them.
        """
        rows = self._episodes
        ends = [(row["row"], row["env"]) for row in rows]
        rewards = np.concatenate(self._rewards) if self._rewards else np.empty(0)
        outcome = RolloutOutcome(
            rewards=rewards,
            episodes=Episodes(
                step=np.array([row["step"] for row in rows], dtype=np.int64),
                variant=np.array([row["variant"] for row in rows], dtype=np.float64).reshape(
                    len(rows), len(self.env.task_parameters)
                ),
                reward=np.array([row["reward"] for row in rows], dtype=np.float64),
                length=np.array([row["length"] for row in rows], dtype=np.int64),
                success=np.array([row["success"] for row in rows], dtype=np.bool_),
                diverged=np.array([row["diverged"] for row in rows], dtype=np.bool_),
            ),
            value_errors=None if advantages is None else self._errors.add(advantages, ends),
            steps_before=self.steps - rewards.size,
        )
        self._forget()
        return outcome

    def state_dict(self) -> dict[str, Any]:
        """Return the environments' state and the running sums of unfinished episodes."""
        return {
            "env": self.env.state_dict(),
            "steps": self.steps,
            "episode_reward": self._episode_reward.copy(),
            "episode_length": self._episode_length.copy(),
            "errors": self._errors.state_dict(),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved state."""
        self.env.load_state_dict(state["env"])
        self.steps = int(state["steps"])
        self._episode_reward = np.array(state["episode_reward"], dtype=np.float64)
        self._episode_length = np.array(state["episode_length"], dtype=np.int64)
        self._errors.load_state_dict(state["errors"])

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

    def _forget(self) -> None:
        self._rewards: list[FloatArray] = []
        self._episodes: list[dict[str, Any]] = []

    def _end_episode(self, index: int, terminated: bool, infos: Infos) -> dict[str, Any]:
        final: Infos = infos["final_info"]
        reward, length = float(self._episode_reward[index]), int(self._episode_length[index])
        success = bool(final["is_success"][index])
        self._episodes.append(
            {
                "row": len(self._rewards) - 1,
                "env": index,
                "step": self.steps,
                "variant": np.array(final["variant"][index], dtype=np.float64),
                "reward": reward,
                "length": length,
                "success": success,
                "diverged": bool(final["diverged"][index]),
            }
        )
        self._episode_reward[index] = 0.0
        self._episode_length[index] = 0
        return {
            "terminal_observation": infos["final_obs"][index],
            "TimeLimit.truncated": not terminated,
            "is_success": success,
            "episode": {"r": reward, "l": length, "t": 0.0},
        }
