"""Gaussian actions in closed form agree with PyTorch's distributions."""

from __future__ import annotations

import torch

from surmount.learn.gaussian import entropy, log_density, log_density_of_noise

GENERATOR = torch.Generator().manual_seed(0)
MEANS = torch.randn(50, 3, generator=GENERATOR)
NOISE = torch.randn(50, 3, generator=GENERATOR)
LOG_STD = torch.tensor([-1.5, 0.0, 0.7])
PEER = torch.distributions.Independent(torch.distributions.Normal(MEANS, LOG_STD.exp()), 1)


def test_densities_and_entropy_are_those_of_torch_distributions():
    actions = MEANS + LOG_STD.exp() * NOISE
    expected = PEER.log_prob(actions)
    torch.testing.assert_close(log_density(actions, MEANS, LOG_STD), expected)
    torch.testing.assert_close(log_density_of_noise(NOISE, LOG_STD), expected)
    torch.testing.assert_close(entropy(LOG_STD), PEER.entropy()[0])


def test_gradients_are_those_of_torch_distributions():
    means, log_std = MEANS.clone().requires_grad_(), LOG_STD.clone().requires_grad_()
    actions = MEANS + LOG_STD.exp() * NOISE
    peer = torch.distributions.Normal(means, log_std.exp())
    expected = torch.autograd.grad(peer.log_prob(actions).sum(), [means, log_std])
    found = torch.autograd.grad(log_density(actions, means, log_std).sum(), [means, log_std])
    for ours, theirs in zip(found, expected, strict=True):
        torch.testing.assert_close(ours, theirs, rtol=1e-4, atol=1e-4)
