"""Learners by name: this package's, and one like the paper's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from surmount.core.configuration import nearest, override
from surmount.core.errors import ConfigError
from surmount.learn.config import LearnerConfig

LEARNERS = ("surmount", "ml-agents")
_PREFIX = "learner."

ML_AGENTS: Mapping[str, Any] = {
    "learner.activation": "silu",
    "learner.initialisation": "kaiming",
    "learner.policy_head_scale": 0.2,
    "learner.action_divisor": 3.0,
    "learner.time_horizon": 64,
    "learner.adam_epsilon": 1e-8,
    "learner.decay_steps": 10_000_000,
    "learner.clip_per_action": True,
    "learner.mean_entropy": True,
    "learner.normalise_advantages": "rollout",
    "learner.clip_values": True,
    "learner.max_gradient_norm": None,
    "learner.normalise_observations": False,
    "learner.normalise_rewards": False,
}
"""PPO of ML-Agents, release 22, as changes of an experiment's configuration.

Hyper-parameters that are not here are alike: step size, γ, λ, clipping range, weights of entropy
and value, passes, batch. Assumed is the length of the decay: ML-Agents decays over ``max_steps``,
which the paper does not tell. A run under a curriculum whose length nobody knows is begun with a
generous one, and 10⁷ is the upper end of what ML-Agents documents as typical; over a million steps
the step size then falls by a tenth.
"""


def ml_agents_learner(**changes: Any) -> LearnerConfig:
    """Return the learner like the paper's, with changes by the names of fields.

    Times in seconds may be among them: ``ml_agents_learner(discount_time_s=5.0)``.
    """
    return learner_preset("ml-agents", **changes)


def learner_preset(name: str, **changes: Any) -> LearnerConfig:
    """Return a learner by name, with changes by the names of fields.

    ``surmount`` is :class:`LearnerConfig` as it is, ``ml-agents`` has :data:`ML_AGENTS`.

    Raises
    ------
    ConfigError
        If there is no such learner or no such field.
    """
    if name not in LEARNERS:
        raise ConfigError(f"Unknown learner `{name}`.", remedy=nearest(name, [*LEARNERS]))
    fields = {} if name == "surmount" else ML_AGENTS
    named = {key.removeprefix(_PREFIX): value for key, value in fields.items()}
    return override(LearnerConfig(), {**named, **changes})
