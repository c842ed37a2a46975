"""PPO's loss on one batch with its gradients, and the roll-out as tensors to draw batches from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import torch
from stable_baselines3.common.buffers import RolloutBuffer

from surmount.learn.gaussian import entropy, log_densities_of_noise, log_density_of_noise
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
        parts = {name: values[order].split(size) for name, values in vars(self).items()}
        for batch in range(len(parts["returns"])):
            yield Batch(**{name: rows[batch] for name, rows in parts.items()})


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
        The weighted sum.
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Slopes:
    """Gradients of the weighted sum of PPO's losses in what the networks gave.

    Attributes
    ----------
    means, values
        Shape ``(row, action)`` and ``(row,)``.
    log_std
        ``(action,)``.
    """

    means: torch.Tensor
    values: torch.Tensor
    log_std: torch.Tensor


def ppo_gradients(networks: ActorCritic, batch: Batch, objective: Objective) -> Loss:
    """Return the loss on a batch, and leave its gradients in the weights' ``grad``.

    What stands there is written over; each weight must have one.
    """
    with torch.no_grad():
        actor = networks.actor.forward(batch.observations)
        critic = networks.critic.forward(batch.observations)
        loss, slopes = ppo_loss(
            actor.outputs, critic.outputs.flatten(), networks.log_std, batch, objective
        )
        networks.actor.backward(actor, slopes.means)
        networks.critic.backward(critic, slopes.values[:, None])
        if networks.log_std.grad is not None:
            networks.log_std.grad.copy_(slopes.log_std)
    return loss


def ppo_loss(
    means: torch.Tensor,
    values: torch.Tensor,
    log_std: torch.Tensor,
    batch: Batch,
    objective: Objective,
) -> tuple[Loss, Slopes]:
    """Return the clipped surrogate loss (Schulman et al. 2017) and its gradients.

    With densities of whole rows it is Stable-Baselines3's. With one density per action, each
    action's ratio is clipped by itself and weighs alike, as in ML-Agents.

    Parameters
    ----------
    means, values
        What actor and critic give, ``(row, action)`` and ``(row,)``.
    log_std
        Logarithm of the standard deviation of each action, ``(action,)``.
    batch, objective
        What to learn from, and towards what.
    """
    clip_range = objective.clip_range
    advantages = batch.advantages
    if objective.normalise_advantages and len(advantages) > 1:
        advantages = (advantages - advantages.mean()) / (advantages.std() + ADVANTAGE_EPSILON)
    per_action = batch.log_probs.dim() > 1
    precision = torch.exp(-log_std)
    noise = (batch.actions - means) * precision
    density = log_densities_of_noise if per_action else log_density_of_noise
    log_ratio = density(noise, log_std) - batch.log_probs
    ratio = log_ratio.exp()
    if per_action:
        advantages = advantages[:, None]
    gain, clipped = advantages * ratio, advantages * ratio.clamp(1 - clip_range, 1 + clip_range)
    policy = -torch.min(gain, clipped).mean()
    # Where the clipped gain is the smaller one, the ratio has no say; a density's slope in its
    # mean is noise / std, in the logarithm of its deviation noise² - 1.
    pull = torch.where(gain <= clipped, gain, 0.0) / -gain.numel()
    pull = pull if per_action else pull[:, None]
    errors = values - batch.returns
    squares, value_slopes = errors.square(), 2 * errors
    if objective.clip_values:
        change = values - batch.values
        near = batch.values + change.clamp(-clip_range, clip_range) - batch.returns
        outside = (change.abs() > clip_range) & (near.square() > squares)
        value_slopes = torch.where(outside, 0.0, value_slopes)
        squares = torch.max(squares, near.square())
    value = squares.mean()
    negative_entropy, share = -entropy(log_std), 1.0
    if objective.mean_entropy:
        share = 1.0 / log_std.numel()
        negative_entropy = negative_entropy * share
    slopes = Slopes(
        means=pull * noise * precision,
        values=value_slopes * (objective.value_coefficient / errors.numel()),
        log_std=(pull * (noise.square() - 1)).sum(dim=0) - objective.entropy_coefficient * share,
    )
    with torch.no_grad():
        clip_fraction = ((ratio - 1).abs() > clip_range).float().mean()
        divergence = ratio - 1 - log_ratio
        approx_kl = (divergence.sum(dim=1) if per_action else divergence).mean()
    loss = Loss(
        total=policy
        + objective.entropy_coefficient * negative_entropy
        + objective.value_coefficient * value,
        policy=policy,
        value=value,
        entropy=negative_entropy,
        clip_fraction=clip_fraction,
        approx_kl=approx_kl,
    )
    return loss, slopes


def _flat(buffer: RolloutBuffer, values: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(buffer.swap_and_flatten(values)).float()
