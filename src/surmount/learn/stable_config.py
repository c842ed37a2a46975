"""What a model of Stable-Baselines3's kind is made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import gymnasium

from surmount.core.errors import InputError
from surmount.envs.observations import is_image
from surmount.learn.config import LearnerConfig

ALGORITHM = "algorithm"
"""Key of a network's record: how the model was made that it is the policy of."""


@dataclass(frozen=True, kw_only=True)
class StableConfig:
    """An algorithm, its arguments and the wrappers of its environments, all JSON values.

    Attributes
    ----------
    algorithm
        A name, or ``module:function``.
    arguments
        Keyword arguments of a named algorithm.
    vec_normalize
        Keyword arguments of ``VecNormalize``; ``None`` for none.
    frame_stack
        Observations stacked; 1 for none.
    """

    algorithm: str
    arguments: Mapping[str, Any] = field(default_factory=dict[str, Any])
    vec_normalize: Mapping[str, Any] | None = None
    frame_stack: int = 1

    @classmethod
    def named(cls, config: LearnerConfig) -> StableConfig:
        """Return what a configuration that names an algorithm asks for."""
        normalise = config.vec_normalize
        if normalise is not None and "gamma" in config.arguments:
            # Returns are discounted as the algorithm discounts them, unless the user says so.
            normalise = {"gamma": config.arguments["gamma"], **normalise}
        return cls(
            algorithm=config.algorithm,
            arguments=dict(config.arguments),
            vec_normalize=None if normalise is None else dict(normalise),
            frame_stack=config.frame_stack,
        )

    @classmethod
    def like_own(
        cls, config: LearnerConfig, step_s: float, observations: gymnasium.Space[Any]
    ) -> StableConfig:
        """Return PPO of Stable-Baselines3 with the hyper-parameters of the own one."""
        rates = config.at_interval(step_s)
        limit = config.max_gradient_norm
        scaled = _scaled_entries(observations) if config.normalise_observations else ()
        normalise: dict[str, Any] | None = None
        if scaled or config.normalise_rewards:
            normalise = {
                "norm_obs": bool(scaled),
                "norm_reward": config.normalise_rewards,
                "gamma": rates.discount,
            }
            if scaled and isinstance(observations, gymnasium.spaces.Dict):
                normalise["norm_obs_keys"] = list(scaled)
        return cls(
            algorithm="PPO",
            arguments={
                "n_steps": config.rollout_steps,
                "batch_size": config.batch_size,
                "n_epochs": config.epochs,
                "learning_rate": config.learning_rate,
                "gamma": rates.discount,
                "gae_lambda": rates.gae_lambda,
                "clip_range": config.clip_range,
                "ent_coef": config.entropy_coefficient,
                "vf_coef": config.value_coefficient,
                "max_grad_norm": 1e9 if limit is None else limit,
                "device": "cpu",
                "policy_kwargs": {
                    "net_arch": list(config.hidden_layers),
                    "activation_fn": f"torch.nn:{_MODULES[config.activation]}",
                },
            },
            vec_normalize=normalise,
        )

    def to_record(self) -> dict[str, Any]:
        """Return it as JSON values."""
        return asdict(self)

    @classmethod
    def from_record(cls, record: Any) -> StableConfig:
        """Read what :meth:`to_record` returned.

        Raises
        ------
        InputError
            If it is something else.
        """
        kinds: dict[str, Any] = {"algorithm": str, "arguments": dict,
                                 "vec_normalize": (dict, type(None)),
                 "frame_stack": int}  # fmt: skip
        if (
            isinstance(record, dict)
            and record.keys() == kinds.keys()
            and all(isinstance(record[name], kind) for name, kind in kinds.items())
        ):
            return cls(**record)
        raise InputError(
            f"The network's record says algorithm {str(record)[:80]}.",
            remedy="Give a `network.safetensors` that Surmount wrote.",
        )


_MODULES = {"tanh": "Tanh", "relu": "ReLU", "silu": "SiLU"}


def _scaled_entries(observations: gymnasium.Space[Any]) -> tuple[str, ...]:
    """Return the entries of observations that are numbers to standardise; "" for all of a box."""
    parts = (
        observations.spaces.items()
        if isinstance(observations, gymnasium.spaces.Dict)
        else [("", observations)]
    )
    return tuple(
        name
        for name, part in parts
        if isinstance(part, gymnasium.spaces.Box) and not is_image(part)
    )
