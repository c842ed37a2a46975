"""The networks of a Stable-Baselines3 policy as plain matrix products, with their gradients.

Calling the policy builds a distribution and walks through a tree of modules for every step,
which takes several times as long as the products themselves when only nine rows go in. Small
batches of small networks learn at half the cost without a graph of what was computed
(docs/adr/0093).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from stable_baselines3.common.distributions import DiagGaussianDistribution
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.preprocessing import is_image_space
from stable_baselines3.common.torch_layers import FlattenExtractor
from torch.nn import functional

Activation = Callable[[torch.Tensor], torch.Tensor]
Derivative = Callable[[torch.Tensor, torch.Tensor, torch.Tensor], torch.Tensor]


@dataclass(frozen=True)
class ActivationKind:
    """A module of PyTorch and the functions that do its work.

    Attributes
    ----------
    module
        The module that Stable-Baselines3 builds its networks with.
    function
        The same.
    in_place
        The same, writing over its argument.
    backward
        From the gradient in what comes out, what went in and what came out, the gradient in what
        went in.
    """

    module: type[torch.nn.Module]
    function: Activation
    in_place: Activation
    backward: Derivative


def _tanh(values: torch.Tensor) -> torch.Tensor:
    # NumPy's takes a sixth of the time of PyTorch's on processors with AVX-512.
    return torch.from_numpy(np.tanh(values.numpy()))


def _tanh_in_place(values: torch.Tensor) -> torch.Tensor:
    entries = values.numpy()
    np.tanh(entries, out=entries)
    return values


ACTIVATIONS: dict[str, ActivationKind] = {
    "tanh": ActivationKind(
        torch.nn.Tanh,
        _tanh,
        _tanh_in_place,
        lambda gradient, _, after: torch.ops.aten.tanh_backward(gradient, after),
    ),
    "relu": ActivationKind(
        torch.nn.ReLU,
        torch.relu,
        torch.relu_,
        lambda gradient, _, after: torch.ops.aten.threshold_backward(gradient, after, 0),
    ),
    "silu": ActivationKind(
        torch.nn.SiLU,
        functional.silu,
        lambda values: functional.silu(values, inplace=True),
        lambda gradient, before, _: torch.ops.aten.silu_backward(gradient, before),
    ),
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Pass:
    """What a network computed for a batch, kept for the gradients.

    Attributes
    ----------
    outputs
        Shape ``(row, output)``.
    inputs
        What went into each layer, ``(row, input)``; those of the first are the network's.
    before
        What went into each activation, ``(row, unit)``.
    """

    outputs: torch.Tensor
    inputs: list[torch.Tensor]
    before: list[torch.Tensor]


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

    def forward(self, inputs: torch.Tensor) -> Pass:
        """Return the outputs for inputs of shape ``(row, input)``, and what led to them."""
        *hidden, last = self._layers
        entered, before = [inputs], []
        for layer in hidden:
            before.append(functional.linear(entered[-1], layer.weight, layer.bias))
            entered.append(self._activation.function(before[-1]))
        outputs = functional.linear(entered[-1], last.weight, last.bias)
        return Pass(outputs=outputs, inputs=entered, before=before)

    def backward(self, done: Pass, gradient: torch.Tensor) -> None:
        """Write the gradients of all weights into their ``grad``, over what stands there.

        Parameters
        ----------
        done
            What :meth:`forward` returned for the weights of now.
        gradient
            Of the loss in the outputs, ``(row, output)``.
        """
        for place in reversed(range(len(self._layers))):
            layer = self._layers[place]
            torch.mm(gradient.t(), done.inputs[place], out=layer.weight.grad)
            torch.sum(gradient, dim=0, out=layer.bias.grad)
            if place:
                after, before = done.inputs[place], done.before[place - 1]
                gradient = self._activation.backward(gradient @ layer.weight, before, after)

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
