"""The networks of a Stable-Baselines3 policy as plain matrix products.

Calling the policy builds a distribution and walks through a tree of modules for every step,
which takes several times as long as the products themselves when only nine rows go in.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import torch
from stable_baselines3.common.distributions import DiagGaussianDistribution
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.preprocessing import is_image_space
from stable_baselines3.common.torch_layers import FlattenExtractor
from torch.nn import functional

Activation = Callable[[torch.Tensor], torch.Tensor]


@dataclass(frozen=True)
class ActivationKind:
    """A module of PyTorch and the functions that do its work.

    Attributes
    ----------
    module
        The module that Stable-Baselines3 builds its networks with.
    function
        The same, differentiable.
    in_place
        The same, writing over its argument.
    """

    module: type[torch.nn.Module]
    function: Activation
    in_place: Activation


ACTIVATIONS: dict[str, ActivationKind] = {
    "tanh": ActivationKind(torch.nn.Tanh, torch.tanh, torch.tanh_),
    "relu": ActivationKind(torch.nn.ReLU, torch.relu, torch.relu_),
    "silu": ActivationKind(
        torch.nn.SiLU, functional.silu, lambda values: functional.silu(values, inplace=True)
    ),
}


class MLP:
    """Linear layers with an activation between them, sharing a policy's weights.

    Parameters
    ----------
    layers
        The policy's own layers, so that gradients reach its optimiser.
    activation
        Applied to every layer but the last.
    """

    def __init__(self, layers: list[torch.nn.Linear], activation: ActivationKind) -> None:
        self._layers = layers
        self._activation = activation

    def __call__(self, inputs: torch.Tensor) -> torch.Tensor:
        """Return the outputs, shape ``(row, output)``, differentiable in the weights."""
        *hidden, last = self._layers
        for layer in hidden:
            inputs = self._activation.function(functional.linear(inputs, layer.weight, layer.bias))
        return functional.linear(inputs, last.weight, last.bias)

    def frozen(self) -> Activation:
        """Return a function that gives the outputs for the weights of now, without gradients.

        It holds the weights transposed, as the products over few rows want them; the weights may
        change afterwards without its noticing.
        """
        *hidden, last = [
            (
                layer.bias.detach().clone(),
                layer.weight.detach().t().clone(memory_format=torch.contiguous_format),
            )
            for layer in self._layers
        ]
        in_place = self._activation.in_place

        def outputs(inputs: torch.Tensor) -> torch.Tensor:
            for bias, weights in hidden:
                inputs = in_place(torch.addmm(bias, inputs, weights))
            bias, weights = last
            return torch.addmm(bias, inputs, weights)

        return outputs


@dataclass(frozen=True, eq=False)
class ActorCritic:
    """What a Gaussian policy consists of.

    Attributes
    ----------
    actor
        From observations to the means of the actions.
    critic
        From observations to their values, one column.
    log_std
        Logarithm of the standard deviation of each action, shape ``(action,)``.
    """

    actor: MLP
    critic: MLP
    log_std: torch.Tensor

    @classmethod
    def of(cls, policy: ActorCriticPolicy) -> ActorCritic | None:
        """Return the networks of a policy, or None if it is made in another way.

        Known are policies of Stable-Baselines3's ``MlpPolicy`` with continuous actions: no images,
        no state-dependent exploration.
        """
        if (
            type(policy) is not ActorCriticPolicy
            or type(policy.action_dist) is not DiagGaussianDistribution
            or type(policy.features_extractor) is not FlattenExtractor
            or is_image_space(policy.observation_space)
        ):
            return None
        actor = _perceptron(policy.mlp_extractor.policy_net, policy.action_net)
        critic = _perceptron(policy.mlp_extractor.value_net, policy.value_net)
        if actor is None or critic is None:
            return None
        return cls(actor=actor, critic=critic, log_std=policy.log_std)


def _perceptron(body: torch.nn.Module, head: torch.nn.Module) -> MLP | None:
    modules = [*body.children(), head]
    layers = [module for module in modules[::2] if type(module) is torch.nn.Linear]
    kinds = {type(module) for module in modules[1::2]}
    for kind in ACTIVATIONS.values():
        if len(layers) == len(modules[::2]) and kinds == {kind.module}:
            return MLP(layers, kind)
    return None
