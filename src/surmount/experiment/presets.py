"""Presets: the paper's scale, and a small one that runs through in minutes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from surmount.analysis.configuration import AnalysisConfig
from surmount.core.configuration import nearest, override, to_record
from surmount.core.errors import ConfigError
from surmount.envs.registry import find_family
from surmount.experiment.config import ExperimentConfig, config_class
from surmount.learn.config import AUTO, OF_ALL, OWN, LearnerConfig
from surmount.learn.rollout_config import RolloutConfig
from surmount.teachers.advancement import AdvancementConfig

PRESETS = ("smoke", "paper")
ALGORITHM = "learner.algorithm"
"""Key of the algorithm that learns."""
TIMES = {
    "learner.discount": "learner.discount_time_s",
    "learner.gae_lambda": "learner.gae_time_s",
}
"""Keys of factors per step, with those of the times that say the same at any step."""
DISPLACING = (ALGORITHM, *TIMES)
"""Keys that others of a preset make way for (:func:`configured`)."""

SMOKE_PERCENT = 30
"""Share of the paper's: enough to learn to drive, not to master the obstacle. Of 20 and 30 the
first at which the demo's analysis finds more than one group (20 one, 30 three, under the settings
of ADR 23), whatever the arms then did."""


def preset(task: str, name: str, *, calibrated: bool = True) -> ExperimentConfig:
    """Return the configuration of a family of tasks at a scale.

    ``paper`` follows the paper's section III, with five networks instead of two. ``smoke`` runs
    every stage on a fraction of the steps and trials, to show the method at work and to test it;
    its results say nothing about the method's merit. Both begin from what the family was calibrated
    to (:attr:`~surmount.envs.family.TaskFamily.calibrated`).

    Parameters
    ----------
    task
        Name of a registered family of tasks, or ``module:function``.
    name
        ``"smoke"`` or ``"paper"``.
    calibrated
        Whether to begin from that; a search for such settings does not.

    Raises
    ------
    ConfigError
        If the task or the preset is unknown.
    """
    if name not in PRESETS:
        raise ConfigError(f"Unknown preset `{name}`.", remedy=nearest(name, [*PRESETS]))
    family = find_family(task)
    experiment = config_class(family.settings)
    begun = override(
        experiment(task=family.name, preset=name, initial_steps=family.initial_steps),
        family.calibrated if calibrated else {},
    )
    if name == "paper":
        return begun
    return replace(
        begun,
        networks=2,
        initial_steps=SMOKE_PERCENT * family.initial_steps // 100,
        checkpoint_steps=20_000,
        learner=replace(begun.learner, rollout_steps=512, batch_size=512, epochs=6),
        trials=RolloutConfig(repetitions=8),
        analysis=AnalysisConfig(max_components=12),
        advancement=AdvancementConfig(
            iteration_steps=30_000,
            extension_steps=10_000,
            window_steps=5_000,
            # The first test never passes: with one extension, every level would last as long.
            max_extensions=2,
        ),
        tests=RolloutConfig(repetitions=8),
    )


def configured(config: ExperimentConfig, changes: Mapping[str, Any]) -> ExperimentConfig:
    """Return a configuration with dotted keys changed.

    What a preset chose makes way for what is asked for: all hyper-parameters of Surmount's own PPO
    where another algorithm is chosen, a time in seconds where a factor per step is given.

    Raises
    ------
    ConfigError
        If a key is unknown, or a value cannot be used.
    """
    algorithm = str(changes.get(ALGORITHM, config.learner.algorithm)).strip('"')
    if algorithm in (AUTO, OWN) or not config.learner.uses_own_fields:
        way = {time: None for factor, time in TIMES.items() if factor in changes}
        return override(config, way | dict(changes))
    plain = to_record(LearnerConfig())
    own = {
        f"learner.{one.name}": plain[one.name]
        for one in fields(LearnerConfig)
        if one.name not in OF_ALL
    }
    return override(config, own | dict(changes))
