"""How the weights of a new policy are drawn."""

from __future__ import annotations

from typing import cast

import torch
from stable_baselines3.common.policies import ActorCriticPolicy

from surmount.learn.config import LearnerConfig

ORTHOGONAL_HEAD_SCALE = 0.01
"""Gain that Stable-Baselines3 gives the actor's last layer."""


def initialise(policy: ActorCriticPolicy, config: LearnerConfig) -> None:
    """Give a policy that Stable-Baselines3 has just made the initial weights configured.

    Stable-Baselines3's own are left untouched where they are what is wanted. The kaiming ones are
    those of ML-Agents: hidden layers and the actor's last one normal with variance 1 / inputs, the
    latter scaled; the critic's last one uniform after Glorot; biases zero.
    """
    head = cast("torch.nn.Linear", policy.action_net)
    if config.initialisation == "orthogonal":
        if config.policy_head_scale != ORTHOGONAL_HEAD_SCALE:
            with torch.no_grad():
                head.weight.mul_(config.policy_head_scale / ORTHOGONAL_HEAD_SCALE)
        return
    layers = [part for part in policy.modules() if isinstance(part, torch.nn.Linear)]
    with torch.no_grad():
        for layer in layers:
            if layer is policy.value_net:
                torch.nn.init.xavier_uniform_(layer.weight)
            else:
                torch.nn.init.kaiming_normal_(layer.weight, nonlinearity="linear")
            torch.nn.init.zeros_(layer.bias)
        head.weight.mul_(config.policy_head_scale)
