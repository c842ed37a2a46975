"""PPO's loss on one batch, and the roll-out as tensors to draw batches from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import torch
from stable_baselines3.common.buffers import RolloutBuffer
from torch.nn import functional

from surmount.learn.gaussian import entropy, log_density
from surmount.learn.mlp import ActorCritic

ADVANTAGE_EPSILON = 1e-8
"""Added to the deviation of a batch's advantages (Stable-Baselines3's)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Batch:
    """Decisions to learn from, one row each.

    Attributes
    ----------
    observations, actions
        Shape ``(row, observation)`` and ``(row, action)``.
    log_probs
        Logarithm of the density of each action when it was taken, ``(row,)``.
    advantages, returns
        Generalised advantages, and the targets of the critic, ``(row,)``.
    """

    observations: torch.Tensor
    actions: torch.Tensor
    log_probs: torch.Tensor
    advantages: torch.Tensor
    returns: torch.Tensor

    @classmethod
    def whole(cls, buffer: RolloutBuffer) -> Batch:
        """Return a full buffer, environment by environment as Stable-Baselines3 flattens it."""
        return cls(
            observations=_flat(buffer, buffer.observations).flatten(1),
            actions=_flat(buffer, buffer.actions),
            log_probs=_flat(buffer, buffer.log_probs).flatten(),
            advantages=_flat(buffer, buffer.advantages).flatten(),
            returns=_flat(buffer, buffer.returns).flatten(),
        )

    def shuffled(self, size: int) -> Iterator[Batch]:
        """Pass once over all rows in random order, drawn as Stable-Baselines3 draws it."""
        order = torch.from_numpy(np.random.permutation(len(self.returns)))  # noqa: NPY002
        for rows in order.split(size):
            yield Batch(**{name: values[rows] for name, values in vars(self).items()})


@dataclass(frozen=True, kw_only=True, eq=False)
class Loss:
    """PPO's loss on a batch and what is logged about it, all scalars.

    Attributes
    ----------
    total
        The weighted sum, to be differentiated.
    policy, value, entropy
        Its parts before weighting; the entropy is negated.
    clip_fraction
        Share of the rows whose probability ratio is outside the clipping range.
    approx_kl
        Estimate of the divergence from the policy that acted (http://joschu.net/blog/kl-approx.html).
    """

    total: torch.Tensor
    policy: torch.Tensor
    value: torch.Tensor
    entropy: torch.Tensor
    clip_fraction: torch.Tensor
    approx_kl: torch.Tensor


def ppo_loss(
    networks: ActorCritic,
    batch: Batch,
    *,
    clip_range: float,
    entropy_coefficient: float,
    value_coefficient: float,
) -> Loss:
    """Return the clipped surrogate loss (Schulman et al. 2017) as Stable-Baselines3 has it."""
    advantages = batch.advantages
    if len(advantages) > 1:
        advantages = (advantages - advantages.mean()) / (advantages.std() + ADVANTAGE_EPSILON)
    log_probs = log_density(batch.actions, networks.actor(batch.observations), networks.log_std)
    log_ratio = log_probs - batch.log_probs
    ratio = log_ratio.exp()
    clipped = ratio.clamp(1 - clip_range, 1 + clip_range)
    policy = -torch.min(advantages * ratio, advantages * clipped).mean()
    value = functional.mse_loss(networks.critic(batch.observations).flatten(), batch.returns)
    negative_entropy = -entropy(networks.log_std)
    with torch.no_grad():
        clip_fraction = ((ratio - 1).abs() > clip_range).float().mean()
        approx_kl = (ratio - 1 - log_ratio).mean()
    return Loss(
        total=policy + entropy_coefficient * negative_entropy + value_coefficient * value,
        policy=policy.detach(),
        value=value.detach(),
        entropy=negative_entropy.detach(),
        clip_fraction=clip_fraction,
        approx_kl=approx_kl,
    )


def _flat(buffer: RolloutBuffer, values: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(buffer.swap_and_flatten(values)).float()
