"""A policy's networks as plain products give what the policy gives."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
import torch
from stable_baselines3.common.policies import ActorCriticPolicy

from surmount.learn.mlp import ACTIVATIONS, ActorCritic

OBSERVATIONS = torch.randn(20, 5, generator=torch.Generator().manual_seed(0))


def policy_with(activation: torch.nn.Module, observation_space=None) -> ActorCriticPolicy:
    torch.manual_seed(1)
    return ActorCriticPolicy(
        observation_space or gymnasium.spaces.Box(-1, 1, (5,), np.float32),
        gymnasium.spaces.Box(-1, 1, (2,), np.float32),
        lambda _: 1e-3,
        net_arch=[12, 8],
        activation_fn=activation,
    )


@pytest.mark.parametrize("activation", list(ACTIVATIONS))
def test_outputs_are_the_policys(activation):
    policy = policy_with(ACTIVATIONS[activation].module)
    networks = ActorCritic.of(policy)
    with torch.no_grad():
        means = policy.get_distribution(OBSERVATIONS).distribution.mean
        values = policy.predict_values(OBSERVATIONS)
        found = [
            (net.forward(OBSERVATIONS).outputs, net.frozen()(OBSERVATIONS))
            for net in (networks.actor, networks.critic)
        ]
    for outputs, expected in zip(found, (means, values), strict=True):
        for output in outputs:
            torch.testing.assert_close(output, expected)


@pytest.mark.parametrize("activation", list(ACTIVATIONS))
def test_gradients_are_those_of_autograd(activation):
    policy = policy_with(ACTIVATIONS[activation].module)
    networks = ActorCritic.of(policy)
    slopes = torch.randn(20, 2, generator=torch.Generator().manual_seed(3))
    policy.get_distribution(OBSERVATIONS).distribution.mean.backward(slopes)
    expected = {
        name: weight.grad.clone()
        for name, weight in policy.named_parameters()
        if weight.grad is not None
    }
    for weight in policy.parameters():
        weight.grad = torch.full_like(weight, torch.nan)
    with torch.no_grad():
        networks.actor.backward(networks.actor.forward(OBSERVATIONS), slopes)
    assert len(expected) == 6
    for name, gradient in expected.items():
        found = policy.get_parameter(name).grad
        torch.testing.assert_close(found, gradient, rtol=1e-4, atol=1e-5)


def test_frozen_networks_keep_their_weights_and_leave_their_inputs_alone():
    policy = policy_with(torch.nn.Tanh)
    networks = ActorCritic.of(policy)
    frozen, inputs = networks.critic.frozen(), OBSERVATIONS.clone()
    before = frozen(inputs)
    with torch.no_grad():
        for parameter in policy.parameters():
            parameter.add_(0.1)
    assert torch.equal(frozen(inputs), before)
    assert torch.equal(inputs, OBSERVATIONS)
    assert not torch.equal(networks.critic.frozen()(inputs), before)


def test_other_policies_are_not_taken_for_known_ones():
    image = gymnasium.spaces.Box(0, 255, (36, 36, 3), np.uint8)
    assert ActorCritic.of(policy_with(torch.nn.ELU)) is None
    assert ActorCritic.of(policy_with(torch.nn.Tanh, image)) is None
