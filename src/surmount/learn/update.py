"""PPO's loss on one batch, and the roll-out as tensors to draw batches from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import torch
from stable_baselines3.common.buffers import RolloutBuffer
from torch.nn import functional

from surmount.learn.gaussian import entropy, log_densities, log_density
from surmount.learn.mlp import ActorCritic

ADVANTAGE_EPSILON = 1e-8
"""Added to the deviation of a batch's advantages (Stable-Baselines3's)."""
ROLLOUT_ADVANTAGE_EPSILON = 1e-10
"""Added to the deviation of a whole roll-out's advantages (ML-Agents')."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Batch:
    """Steps to learn from, one row each.

    Attributes
    ----------
    observations, actions
        Shape ``(row, observation)`` and ``(row, action)``.
    log_probs
        Logarithm of the density of each row's actions when they were taken, ``(row,)``, or of each
        of them by itself, ``(row, action)``.
    values
        What the critic said when the actions were taken, ``(row,)``.
    advantages, returns
        Generalised advantages, and the targets of the critic, ``(row,)``.
    """

    observations: torch.Tensor
    actions: torch.Tensor
    log_probs: torch.Tensor
    values: torch.Tensor
    advantages: torch.Tensor
    returns: torch.Tensor

    @classmethod
    def whole(cls, buffer: RolloutBuffer) -> Batch:
        """Return a full buffer, environment by environment as Stable-Baselines3 flattens it."""
        return cls(
            observations=_flat(buffer, buffer.observations).flatten(1),
            actions=_flat(buffer, buffer.actions),
            log_probs=_flat(buffer, buffer.log_probs).reshape(-1, *buffer.log_probs.shape[2:]),
            values=_flat(buffer, buffer.values).flatten(),
            advantages=_flat(buffer, buffer.advantages).flatten(),
            returns=_flat(buffer, buffer.returns).flatten(),
        )

    def with_normalised_advantages(self) -> Batch:
        """Return the same with advantages standardised over all rows, as ML-Agents does."""
        spread = self.advantages.std(unbiased=False) + ROLLOUT_ADVANTAGE_EPSILON
        return replace(self, advantages=(self.advantages - self.advantages.mean()) / spread)

    def shuffled(self, size: int) -> Iterator[Batch]:
        """Pass once over all rows in random order, drawn as Stable-Baselines3 draws it."""
        order = torch.from_numpy(np.random.permutation(len(self.returns)))  # noqa: NPY002
        for rows in order.split(size):
            yield Batch(**{name: values[rows] for name, values in vars(self).items()})


@dataclass(frozen=True, kw_only=True)
class Objective:
    """What an update aims at.

    Attributes
    ----------
    clip_range
        Of the probability ratio, and of the value where that is clipped.
    entropy_coefficient, value_coefficient
        Weights of the entropy and of the value loss.
    normalise_advantages
        Whether to standardise the advantages of each batch.
    mean_entropy
        Whether the entropy is the mean over actions instead of their sum.
    clip_values
        Whether the value loss is the larger of those with and without the change clipped.
    """

    clip_range: float
    entropy_coefficient: float
    value_coefficient: float
    normalise_advantages: bool = True
    mean_entropy: bool = False
    clip_values: bool = False


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
        Share of the probability ratios that are outside the clipping range.
    approx_kl
        Estimate of the divergence from the policy that acted (http://joschu.net/blog/kl-approx.html).
    """

    total: torch.Tensor
    policy: torch.Tensor
    value: torch.Tensor
    entropy: torch.Tensor
    clip_fraction: torch.Tensor
    approx_kl: torch.Tensor


def ppo_loss(networks: ActorCritic, batch: Batch, objective: Objective) -> Loss:
    """Return the clipped surrogate loss (Schulman et al. 2017).

    With densities of whole rows it is Stable-Baselines3's. With one density per action, each
    action's ratio is clipped by itself and weighs alike, as in ML-Agents.
    """
    clip_range = objective.clip_range
    advantages = batch.advantages
    if objective.normalise_advantages and len(advantages) > 1:
        advantages = (advantages - advantages.mean()) / (advantages.std() + ADVANTAGE_EPSILON)
    per_action = batch.log_probs.dim() > 1
    density = log_densities if per_action else log_density
    log_probs = density(batch.actions, networks.actor(batch.observations), networks.log_std)
    log_ratio = log_probs - batch.log_probs
    ratio = log_ratio.exp()
    clipped = ratio.clamp(1 - clip_range, 1 + clip_range)
    if per_action:
        advantages = advantages[:, None]
    policy = -torch.min(advantages * ratio, advantages * clipped).mean()
    values = networks.critic(batch.observations).flatten()
    value = functional.mse_loss(values, batch.returns)
    if objective.clip_values:
        near = batch.values + (values - batch.values).clamp(-clip_range, clip_range)
        errors = torch.max((values - batch.returns).square(), (near - batch.returns).square())
        value = errors.mean()
    negative_entropy = -entropy(networks.log_std)
    if objective.mean_entropy:
        negative_entropy = negative_entropy / networks.log_std.numel()
    with torch.no_grad():
        clip_fraction = ((ratio - 1).abs() > clip_range).float().mean()
        divergence = ratio - 1 - log_ratio
        approx_kl = (divergence.sum(dim=1) if per_action else divergence).mean()
    return Loss(
        total=policy
        + objective.entropy_coefficient * negative_entropy
        + objective.value_coefficient * value,
        policy=policy.detach(),
        value=value.detach(),
        entropy=negative_entropy.detach(),
        clip_fraction=clip_fraction,
        approx_kl=approx_kl,
    )


def _flat(buffer: RolloutBuffer, values: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(buffer.swap_and_flatten(values)).float()
