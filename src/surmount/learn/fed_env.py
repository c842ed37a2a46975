"""Environments that return what they are fed, to run wrappers of observations in trials."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices


class FedVecEnv(VecEnv):
    """A vector environment of Stable-Baselines3 without any simulation.

    Attributes
    ----------
    observations
        What the next reset or step returns, one row per environment.
    """

    render_mode: str | None = None

    def __init__(
        self,
        num_envs: int,
        observation_space: gymnasium.Space[Any],
        action_space: gymnasium.Space[Any],
    ) -> None:
        super().__init__(num_envs, observation_space, action_space)
        self.observations: Any = None

    def reset(self) -> Any:
        """Return what was fed."""
        return self.observations

    def step_async(self, actions: np.ndarray) -> None:
        """Take no actions: what they did is fed."""

    def step_wait(self) -> tuple[Any, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Return what was fed; no episode ends."""
        none = np.zeros(self.num_envs, dtype=np.float32)
        return (
            self.observations,
            none,
            none.astype(np.bool_),
            [{} for _ in range(self.num_envs)],
        )

    def close(self) -> None:
        """Release nothing."""

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of this object, once per environment asked for."""
        return [getattr(self, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Set an attribute of this object."""
        del indices
        setattr(self, attr_name, value)

    def env_method(
        self,
        method_name: str,
        *method_args: Any,
        indices: VecEnvIndices = None,
        **method_kwargs: Any,
    ) -> list[Any]:
        """Call a method of this object once per environment asked for."""
        method = getattr(self, method_name)
        return [method(*method_args, **method_kwargs) for _ in self._get_indices(indices)]

    def env_is_wrapped(
        self,
        wrapper_class: type[gymnasium.Wrapper[Any, Any, Any, Any]],
        indices: VecEnvIndices = None,
    ) -> list[bool]:
        """Return false: there are no single environments."""
        del wrapper_class
        return [False for _ in self._get_indices(indices)]
