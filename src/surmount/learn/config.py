"""Configuration of the learner."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from surmount.core.errors import ConfigError


@dataclass(frozen=True, kw_only=True)
class LearnerConfig:
    """PPO through Stable-Baselines3 (paper III-B).

    The paper prints the network and the number of environments. Where it is silent, values
    follow the defaults of ML-Agents, which it used, unless marked otherwise.
    """

    num_envs: int = 9
    """Environments that train at once and share one network (paper III-B)."""

    hidden_layers: tuple[int, ...] = (256, 256, 256, 256)
    """Units of each hidden layer, of policy and value network alike (paper III-B)."""

    activation: Literal["tanh", "relu", "silu"] = "tanh"
    """Activation of the hidden layers (assumed: the default of Stable-Baselines3)."""

    rollout_steps: int = 1024
    """Decisions per environment between updates: 9 · 1,024 = 9,216, the multiple of the batch next
    to ML-Agents' buffer of 10,240 that nine environments can fill."""

    batch_size: int = 1024
    """Learning steps per gradient step (ML-Agents default for continuous actions)."""

    epochs: int = 3
    """Passes over each roll-out (ML-Agents default)."""

    learning_rate: float = 3e-4
    """Step size of Adam (ML-Agents default), constant: the length of a curriculum is not known
    beforehand, so a decay has no end to aim at (assumed)."""

    discount: float = 0.99
    """γ per decision (ML-Agents default)."""

    gae_lambda: float = 0.95
    """λ of generalised advantage estimation (assumed; ML-Agents default 0.95)."""

    clip_range: float = 0.2
    """PPO's clipping of the probability ratio (ML-Agents default)."""

    entropy_coefficient: float = 5e-3
    """Weight of the entropy bonus (ML-Agents default)."""

    value_coefficient: float = 0.5
    """Weight of the value loss (ML-Agents default)."""

    max_gradient_norm: float = 0.5
    """Gradients are clipped to this norm (assumed: the default of Stable-Baselines3)."""

    normalise_observations: bool = True
    """Standardise observations by running statistics (assumed)."""

    normalise_rewards: bool = True
    """Scale rewards by the running deviation of the discounted return (assumed). Eq. 5 and all
    learning curves use rewards before scaling."""

    def __post_init__(self) -> None:
        positive = ("num_envs", "rollout_steps", "batch_size", "epochs", "learning_rate")
        for name in positive:
            if not getattr(self, name) > 0:
                raise ConfigError(
                    f"`learner.{name}` is {getattr(self, name)}.", remedy="Give a positive value."
                )
        for name in ("discount", "gae_lambda"):
            if not 0 <= getattr(self, name) <= 1:
                raise ConfigError(
                    f"`learner.{name}` is {getattr(self, name)}.",
                    remedy="Give a value between 0 and 1.",
                )
        if not self.hidden_layers or min(self.hidden_layers) < 1:
            raise ConfigError(
                f"`learner.hidden_layers` is {self.hidden_layers}.",
                remedy="Give at least one layer of at least one unit.",
            )
        if self.steps_per_rollout % self.batch_size:
            raise ConfigError(
                f"A roll-out of {self.num_envs} x {self.rollout_steps} steps is not a multiple of "
                f"the batch size {self.batch_size}.",
                remedy="Choose `learner.rollout_steps` and `learner.batch_size` so that it is.",
            )

    @property
    def steps_per_rollout(self) -> int:
        """Learning steps between two updates, over all environments."""
        return self.num_envs * self.rollout_steps
