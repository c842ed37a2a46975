"""Configuration of a whole experiment."""

from __future__ import annotations

from dataclasses import dataclass, field

from surmount.analysis import AnalysisConfig
from surmount.core.configuration import absent
from surmount.core.errors import ConfigError
from surmount.core.run_layout import MOST_NETWORKS
from surmount.envs import EnvConfig
from surmount.learn import LearnerConfig, RolloutConfig
from surmount.teachers import AdvancementConfig

MOST_STEPS = 10**12
"""Beyond any run; a mistyped number is told before it fills the memory."""


@dataclass(frozen=True, kw_only=True)
class ExperimentConfig:
    """The protocol of the paper for one obstacle: every choice, frozen and validated."""

    obstacle: str
    """Name of the obstacle: ``narrow-channel``, ``low-entrance`` or ``step``; or
    ``module:function`` for an environment of one's own."""

    scale: str
    """Name of the preset the configuration began as: ``smoke`` or ``paper``."""

    seed: int = 0
    """Root of all seeds; every stage derives its own from it and from its name."""

    networks: int = 5
    """Independent initial networks, each trained on with and without curriculum (the paper: 2)."""

    initial_steps: int = 500_000
    """Learning steps of the initiation over all environments (paper III-C: 500,000 for the
    channel and the entrance, 1,000,000 for the step)."""

    checkpoint_steps: int = 50_000
    """Learning steps between checkpoints: what a kill loses at the most (assumed)."""

    own_sha256: str = field(default="", metadata=absent(""))
    """SHA-256 of the file of one's own environment, empty for RSTAR's obstacles: with another file
    it is another experiment."""

    env: EnvConfig = field(default_factory=EnvConfig)
    """Robot, obstacle course, reward and timing; unused with an environment of one's own."""

    learner: LearnerConfig = field(default_factory=LearnerConfig)
    """PPO."""

    trials: RolloutConfig = field(default_factory=RolloutConfig)
    """Roll-outs after the initiation, from which the curriculum is determined."""

    analysis: AnalysisConfig = field(default_factory=AnalysisConfig)
    """From trials to the curriculum."""

    advancement: AdvancementConfig = field(default_factory=AdvancementConfig)
    """Length of levels and the test that ends them (eq. 5)."""

    tests: RolloutConfig = field(default_factory=RolloutConfig)
    """Roll-outs that test the trained networks."""

    rollout_shards: int = field(default=1, metadata=absent(1))
    """Stages that the roll-outs of a network are divided into by repetitions, to run side by side.
    Each has a seed of its own, so another number gives other trials."""

    def __post_init__(self) -> None:
        for name, least, most in (
            ("networks", 1, MOST_NETWORKS),
            ("initial_steps", 0, MOST_STEPS),
            ("checkpoint_steps", 1, MOST_STEPS),
        ):
            if getattr(self, name) < least:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy=f"Give at least {least}."
                )
            if getattr(self, name) > most:
                raise ConfigError(f"`{name}` is too large.", remedy=f"Give at most {most:,}.")
        fewest = min(self.trials.repetitions, self.tests.repetitions)
        if not 1 <= self.rollout_shards <= fewest:
            raise ConfigError(
                f"`rollout_shards` is {self.rollout_shards}.",
                remedy=f"Give a number from 1 to {fewest}, the repetitions of a variant.",
            )
        if not 0 <= self.seed < 2**31:
            raise ConfigError(
                f"`seed` is {self.seed}.", remedy="Give a number from 0 to 2147483647."
            )
