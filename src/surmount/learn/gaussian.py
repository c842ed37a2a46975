"""Independent Gaussian actions in closed form, without the checks of ``torch.distributions``."""

from __future__ import annotations

import math

import torch

HALF_LOG_2_PI = 0.5 * math.log(2.0 * math.pi)


def log_density(actions: torch.Tensor, means: torch.Tensor, log_std: torch.Tensor) -> torch.Tensor:
    """Return the logarithm of the density of each row, shape ``(row,)``.

    Parameters
    ----------
    actions, means
        Shape ``(row, action)``.
    log_std
        Logarithm of the standard deviations, shape ``(action,)``.
    """
    return log_density_of_noise((actions - means) * torch.exp(-log_std), log_std)


def log_density_of_noise(noise: torch.Tensor, log_std: torch.Tensor) -> torch.Tensor:
    """Return the logarithm of the density of ``mean + std · noise``, over the last axis."""
    constant = log_std.sum() + HALF_LOG_2_PI * noise.shape[-1]
    return -0.5 * noise.square().sum(dim=-1) - constant


def log_densities(
    actions: torch.Tensor, means: torch.Tensor, log_std: torch.Tensor
) -> torch.Tensor:
    """Return the logarithm of the density of each action by itself, shape ``(row, action)``."""
    return log_densities_of_noise((actions - means) * torch.exp(-log_std), log_std)


def log_densities_of_noise(noise: torch.Tensor, log_std: torch.Tensor) -> torch.Tensor:
    """Return the logarithm of the density of each ``mean + std · noise`` by itself."""
    return -0.5 * noise.square() - (log_std + HALF_LOG_2_PI)


def entropy(log_std: torch.Tensor) -> torch.Tensor:
    """Return the entropy of the actions, a scalar: it does not depend on the means."""
    return (log_std + (0.5 + HALF_LOG_2_PI)).sum()
