"""Configuration of the learner."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Literal

from surmount.core.configuration import Arguments, absent
from surmount.core.errors import ConfigError
from surmount.learn.algorithm_names import check_name

POSITIVE = (
    "num_envs",
    "policy_head_scale",
    "action_divisor",
    "rollout_steps",
    "batch_size",
    "epochs",
    "time_horizon",
    "learning_rate",
    "adam_epsilon",
    "decay_steps",
    "discount_time_s",
    "gae_time_s",
    "max_gradient_norm",
)
"""Fields that are positive, or None where they may be left out."""
OWN = "ppo"
"""Name of Surmount's own PPO."""
AUTO = "auto"
"""The own PPO where it can learn, else that of Stable-Baselines3."""
OF_ALL = (
    "algorithm",
    "arguments",
    "vec_normalize",
    "frame_stack",
    "num_envs",
    "rollout_steps",
    "decay_steps",
)
"""Fields that an algorithm chosen by its name reads."""
_OF_BEFORE = {"batch_size": 512, "epochs": 6}
"""What runs of before hold beside such an algorithm, which reads neither."""


@dataclass(frozen=True, kw_only=True)
class PerStep:
    """What a learner's times in seconds are worth from one step to the next.

    Attributes
    ----------
    discount
        γ.
    gae_lambda
        λ of generalised advantage estimation.
    noise_correlation
        Correlation of the exploration noise of successive steps, 0 for white noise.
    """

    discount: float
    gae_lambda: float
    noise_correlation: float


@dataclass(frozen=True, kw_only=True)
class LearnerConfig:
    """Which algorithm learns, and the hyper-parameters of Surmount's own PPO (paper III-B).

    The paper prints the network and the number of environments. Where it is silent, values
    follow the defaults of ML-Agents, which it used, unless marked otherwise. What else ML-Agents
    does differently is a field each, off by default; :mod:`surmount.learn.presets` holds them
    together. Facts about ML-Agents are those of its release 22 (``mlagents`` 1.1.0).
    """

    algorithm: str = field(default=AUTO, metadata=absent(AUTO))
    """``ppo`` is Surmount's own, for boxes; an algorithm of Stable-Baselines3 or sb3-contrib by its
    name, such as ``SAC``; or ``module:function``, a function that takes the vector environment and
    returns a model. ``auto`` takes the own PPO where observations and actions are boxes, and
    otherwise ``PPO`` with the same hyper-parameters."""

    arguments: Arguments = field(default_factory=Arguments, metadata=absent(Arguments()))
    """Keyword arguments of an algorithm chosen by name, such as ``{"gamma": 0.98}``; ``policy``
    and ``device`` are among them, ``module:name`` is a class of yours. Of the fields below only
    ``num_envs``, ``rollout_steps`` and ``decay_steps`` are read then."""

    vec_normalize: Arguments | None = field(default=None, metadata=absent(None))
    """Keyword arguments of Stable-Baselines3's ``VecNormalize`` around the environments of an
    algorithm chosen by name; ``None`` for none, ``{}`` for its defaults."""

    frame_stack: int = field(default=1, metadata=absent(1))
    """Observations stacked by ``VecFrameStack`` for an algorithm chosen by name; 1 for none."""

    num_envs: int = 9
    """Environments that train at once and share one network (paper III-B)."""

    hidden_layers: tuple[int, ...] = (256, 256, 256, 256)
    """Units of each hidden layer, of policy and value network alike (paper III-B)."""

    activation: Literal["tanh", "relu", "silu"] = "tanh"
    """Activation of the hidden layers (assumed: the default of Stable-Baselines3). ML-Agents has
    x · sigmoid(x), here ``silu`` (its ``Swish``, `torch_entities/layers.py`)."""

    initialisation: Literal["orthogonal", "kaiming"] = field(
        default="orthogonal", metadata=absent("orthogonal")
    )
    """How weights are drawn (assumed: ``orthogonal``, as Stable-Baselines3 does). ``kaiming`` is
    ML-Agents': normal with variance 1 / inputs, the critic's last layer uniform with variance
    2 / (inputs + outputs) (`torch_entities/layers.py`, `decoders.py`)."""

    policy_head_scale: float = field(default=0.01, metadata=absent(0.01))
    """Factor on the weights of the actor's last layer (assumed: Stable-Baselines3's; ML-Agents
    has 0.2, `torch_entities/distributions.py`)."""

    action_divisor: float = field(default=1.0, metadata=absent(1.0))
    """What the policy draws is divided by this, then clipped to the action space. 1 clips at one
    standard deviation of a new policy (Stable-Baselines3); 3 is ML-Agents' clamp to ± 3 divided by
    3 (`torch_entities/agent_action.py`)."""

    noise_correlation_s: float = field(default=0.0, metadata=absent(0.0))
    """Time in s after which the correlation of a policy's exploration noise has fallen to 1/e;
    0 for white noise, as in ML-Agents and Stable-Baselines3. The noise is an AR(1) process whose
    marginal stays N(0, 1), so that densities are those of white noise, begun anew with each episode
    (coloured noise in on-policy learning: Hollenstein et al., AAAI 2024). Trials of a network that
    learnt with it draw it too."""

    rollout_steps: int = 1024
    """Steps per environment between updates: 9 · 1,024 = 9,216, the multiple of the batch next
    to ML-Agents' buffer of 10,240 that nine environments can fill."""

    batch_size: int = 1024
    """Learning steps per gradient step (ML-Agents default for continuous actions)."""

    epochs: int = 3
    """Passes over each roll-out (ML-Agents default)."""

    time_horizon: int | None = field(default=None, metadata=absent(None))
    """Steps after which a trajectory is cut for the estimation of advantages, which then lean
    on the critic's value, counted from the beginning of each episode and roll-out. ``None`` cuts at
    the roll-out's end only (Stable-Baselines3); ML-Agents cuts after 64 (`settings.py`)."""

    learning_rate: float = 3e-4
    """Step size of Adam (ML-Agents default)."""

    adam_epsilon: float = field(default=1e-5, metadata=absent(1e-5))
    """ε of Adam (assumed: Stable-Baselines3's; ML-Agents has PyTorch's 1e-8)."""

    decay_steps: int | None = field(default=None, metadata=absent(None))
    """Learning steps, counted from the beginning of each training, over which the learning rate,
    the clipping range and the weight of the entropy fall linearly to 1e-10, 0.1 and 1e-5, as in
    ML-Agents over its ``max_steps`` (`ppo/optimizer_torch.py`). ``None`` keeps them constant: the
    length of a curriculum is not known beforehand, so a decay has no end to aim at (assumed)."""

    discount: float = 0.99
    """γ per step (ML-Agents default). Given instead of `discount_time_s`."""

    discount_time_s: float | None = field(default=None, metadata=absent(None))
    """Time in s after which a reward is worth 1/e: γ = exp(−`step_s` / this), the same
    horizon whatever a step lasts. ``None`` takes γ per step."""

    gae_lambda: float = 0.95
    """λ of generalised advantage estimation per step (ML-Agents default). Given instead of
    `gae_time_s`."""

    gae_time_s: float | None = field(default=None, metadata=absent(None))
    """Time in s after which an advantage leans on the critic for all but 1/e:
    λ = exp(−`step_s` / this). ``None`` takes λ per step."""

    clip_range: float = 0.2
    """PPO's clipping of the probability ratio (ML-Agents default)."""

    clip_per_action: bool = field(default=False, metadata=absent(False))
    """Whether each action's own probability ratio is clipped and the loss is their mean, as in
    ML-Agents (`torch_entities/utils.py`), instead of the ratio of all actions together."""

    entropy_coefficient: float = 5e-3
    """Weight of the entropy bonus (ML-Agents default)."""

    mean_entropy: bool = field(default=False, metadata=absent(False))
    """Whether the bonus is the mean of the actions' entropies, as in ML-Agents
    (`torch_entities/distributions.py`), instead of their sum."""

    normalise_advantages: Literal["batch", "rollout"] = field(
        default="batch", metadata=absent("batch")
    )
    """Whether advantages are standardised in every batch (Stable-Baselines3) or once over the whole
    roll-out (ML-Agents, `trainer/on_policy_trainer.py`)."""

    value_coefficient: float = 0.5
    """Weight of the value loss (ML-Agents default)."""

    clip_values: bool = field(default=False, metadata=absent(False))
    """Whether the value loss is the larger of the losses with and without the value's change
    clipped to the clipping range, as in ML-Agents (`torch_entities/utils.py`)."""

    max_gradient_norm: float | None = 0.5
    """Gradients are clipped to this norm (assumed: the default of Stable-Baselines3); ``None`` for
    none, as in ML-Agents (`ppo/optimizer_torch.py`)."""

    normalise_observations: bool = True
    """Standardise observations by running statistics (assumed; ML-Agents' default is not to)."""

    normalise_rewards: bool = True
    """Scale rewards by the running deviation of the discounted return (assumed; ML-Agents does
    not). Eq. 5 and all learning curves use rewards before scaling."""

    def __post_init__(self) -> None:
        for name in POSITIVE:
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise ConfigError(
                    f"`learner.{name}` is {value}.", remedy="Give a positive, finite value."
                )
        if not 0 <= self.noise_correlation_s < math.inf:
            raise ConfigError(
                f"`learner.noise_correlation_s` is {self.noise_correlation_s}.",
                remedy="Give a time in seconds, or 0 for white noise.",
            )
        for name in ("discount", "gae_lambda"):
            if not 0 <= getattr(self, name) <= 1:
                raise ConfigError(
                    f"`learner.{name}` is {getattr(self, name)}.",
                    remedy="Give a value between 0 and 1.",
                )
        default = {one.name: one.default for one in fields(self)}
        for name, time in (("discount", "discount_time_s"), ("gae_lambda", "gae_time_s")):
            if getattr(self, time) is not None and getattr(self, name) != default[name]:
                raise ConfigError(
                    f"`learner.{name}` and `learner.{time}` are given, which say the same in two "
                    "ways.",
                    remedy=f'Give one of them; `learner.{time} = "null"` takes the time away.',
                )
        if not self.hidden_layers or min(self.hidden_layers) < 1:
            raise ConfigError(
                f"`learner.hidden_layers` is {self.hidden_layers}.",
                remedy="Give at least one layer of at least one unit.",
            )
        self._check_choice()
        if self.uses_own_fields and self.steps_per_rollout % self.batch_size:
            raise ConfigError(
                f"A roll-out of {self.num_envs} x {self.rollout_steps} steps is not a multiple of "
                f"the batch size {self.batch_size}.",
                remedy="Choose `learner.rollout_steps` and `learner.batch_size` so that it is.",
            )

    @property
    def uses_own_fields(self) -> bool:
        """Whether the hyper-parameters here are those that are learnt with."""
        return self.algorithm in (AUTO, OWN)

    def _check_choice(self) -> None:
        if self.frame_stack < 1:
            raise ConfigError(
                f"`learner.frame_stack` is {self.frame_stack}.", remedy="Give at least 1."
            )
        if self.uses_own_fields:
            if self.arguments or self.vec_normalize is not None or self.frame_stack > 1:
                raise ConfigError(
                    "`learner.arguments`, `learner.vec_normalize` and `learner.frame_stack` belong "
                    f"to an algorithm chosen by its name, and `learner.algorithm` is "
                    f"{self.algorithm}.",
                    remedy='Give its name too, such as `learner.algorithm = "PPO"`.',
                )
            return
        check_name(self.algorithm)
        for one in fields(self):
            value = getattr(self, one.name)
            if one.name not in OF_ALL and value not in (one.default, _OF_BEFORE.get(one.name)):
                raise ConfigError(
                    f"`learner.{one.name}` belongs to Surmount's own PPO, and `learner.algorithm` "
                    f"is {self.algorithm}.",
                    remedy="Give the algorithm's own keyword arguments in `learner.arguments`.",
                )

    @property
    def steps_per_rollout(self) -> int:
        """Learning steps between two updates, over all environments."""
        return self.num_envs * self.rollout_steps

    def at_interval(self, step_s: float) -> PerStep:
        """Return what the times in seconds are worth per step.

        Raises
        ------
        ConfigError
            If a time is given and the environment does not say how long a step takes.
        """
        times = (self.discount_time_s, self.gae_time_s, self.noise_correlation_s or None)
        if any(times) and not 0 < step_s < math.inf:
            raise ConfigError(
                f"A step of the environment takes {step_s} s, and the learner has "
                "times in seconds.",
                remedy="Give the environment its `step_s`, or the learner `learner.discount` "
                "and `learner.gae_lambda`, and no correlation of its noise.",
            )
        discount, gae_lambda, correlation = (
            None if time_s is None else math.exp(-step_s / time_s) for time_s in times
        )
        return PerStep(
            discount=self.discount if discount is None else discount,
            gae_lambda=self.gae_lambda if gae_lambda is None else gae_lambda,
            noise_correlation=correlation or 0.0,
        )
