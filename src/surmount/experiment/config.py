"""Configuration of a whole experiment."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field, make_dataclass, replace
from typing import Any

from surmount.analysis.configuration import AnalysisConfig
from surmount.core.configuration import absent, from_record
from surmount.core.errors import ConfigError, InputError
from surmount.envs.family import NoSettings, TaskFamily
from surmount.envs.registry import find_family
from surmount.learn.config import LearnerConfig
from surmount.learn.rollout_config import RolloutConfig
from surmount.teachers.advancement import AdvancementConfig
from surmount.workflow.run_layout import MOST_NETWORKS

MOST_STEPS = 10**12
"""Beyond any run; a mistyped number is told before it fills the memory."""


@dataclass(frozen=True, kw_only=True)
class ExperimentConfig:
    """The protocol of the paper for one family of tasks: every choice, frozen and validated.

    A configuration is an instance of :func:`config_class` of its family, whose ``env`` has the type
    of the family's settings.
    """

    task: str
    """Name of the family of tasks, such as ``rstar/step``; or ``module:function`` for an
    environment of one's own."""

    preset: str
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

    fingerprint: str = field(default="", metadata=absent(""))
    """Hash of what the environments are made from besides ``env``, such as their source or the
    compiled model: filled in when a run begins. With another one it is another experiment."""

    env: Any = field(default_factory=NoSettings)
    """The family's own settings."""

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

    @property
    def family(self) -> TaskFamily:
        """The family of tasks."""
        return find_family(self.task)


@functools.cache
def config_class(settings: type[Any]) -> type[ExperimentConfig]:
    """Return the class of configurations whose ``env`` has a family's settings."""
    return make_dataclass(
        ExperimentConfig.__name__,
        [("env", settings, field(default_factory=settings))],
        bases=(ExperimentConfig,),
        namespace={"__doc__": ExperimentConfig.__doc__, "__module__": __name__},
        frozen=True,
        kw_only=True,
    )


def config_from_record(record: Mapping[str, Any]) -> ExperimentConfig:
    """Read a configuration of any family.

    Raises
    ------
    ConfigError
        If its family is not known, or a key or value is not.
    InputError
        If it names no family.
    """
    task = record.get("task")
    if not isinstance(task, str):
        raise InputError(
            "The configuration names no task.", remedy="Give the configuration of a run."
        )
    family = find_family(task)
    return from_record(config_class(family.settings), {**record, "task": family.name})


def fingerprinted(config: ExperimentConfig) -> ExperimentConfig:
    """Return the configuration with the fingerprint that its environments have now."""
    return replace(config, fingerprint=config.family.fingerprint(config.env))
