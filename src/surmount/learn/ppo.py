"""PPO of Stable-Baselines3, able to go on in the middle of an episode."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

from surmount.learn.config import LearnerConfig

ACTIVATIONS: dict[str, type[torch.nn.Module]] = {
    "tanh": torch.nn.Tanh,
    "relu": torch.nn.ReLU,
    "silu": torch.nn.SiLU,
}


class ResumablePPO(PPO):
    """Stable-Baselines3's PPO whose learning loop can be saved and taken up again.

    Stable-Baselines3 saves networks, but not where the loop stood: its last observation and which
    episodes had just begun. With these, and the environments' own state, ``learn`` goes on
    instead of resetting.
    """

    @classmethod
    def build(cls, env: VecNormalize, config: LearnerConfig, seed: int) -> ResumablePPO:
        """Return a new learner; the seed also sets the global generators it draws from."""
        return cls(
            "MlpPolicy",
            env,
            n_steps=config.rollout_steps,
            batch_size=config.batch_size,
            n_epochs=config.epochs,
            learning_rate=config.learning_rate,
            gamma=config.discount,
            gae_lambda=config.gae_lambda,
            clip_range=config.clip_range,
            ent_coef=config.entropy_coefficient,
            vf_coef=config.value_coefficient,
            max_grad_norm=config.max_gradient_norm,
            policy_kwargs={
                "net_arch": list(config.hidden_layers),
                "activation_fn": ACTIVATIONS[config.activation],
            },
            device="cpu",
            seed=seed,
        )

    @property
    def has_begun(self) -> bool:
        """Whether a roll-out has been collected, so that there is a loop state to save."""
        return self._last_obs is not None

    def learn_one_rollout(self) -> None:
        """Collect one roll-out, going on from the last, and update the networks on it."""
        self.learn(self.n_steps * self.n_envs, reset_num_timesteps=False)

    def loop_state(self) -> dict[str, Any]:
        """Return where the loop stands and the global generators, as arrays and JSON values."""
        kind, keys, position, has_gauss, gauss = np.random.get_state(legacy=True)  # noqa: NPY002
        return {
            "steps": self.num_timesteps,
            "updates": self._n_updates,
            "last_observation": np.asarray(self._last_obs),
            "last_episode_starts": np.asarray(self._last_episode_starts),
            "torch": torch.get_rng_state().numpy(),
            "numpy_keys": np.asarray(keys),
            "numpy": [kind, position, has_gauss, gauss],
        }

    def load_loop_state(self, state: Mapping[str, Any]) -> None:
        """Go on from a saved loop state."""
        self.num_timesteps = int(state["steps"])
        self._n_updates = int(state["updates"])
        self._last_obs = state["last_observation"]
        self._last_episode_starts = state["last_episode_starts"]
        torch.set_rng_state(torch.from_numpy(state["torch"]))
        kind, position, has_gauss, gauss = state["numpy"]
        np.random.set_state((kind, state["numpy_keys"], position, has_gauss, gauss))  # noqa: NPY002
