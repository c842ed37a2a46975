"""Presets: the paper's scale, and a small one that runs through in minutes."""

from __future__ import annotations

from surmount.analysis.configuration import AnalysisConfig
from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError
from surmount.envs.registry import find_family
from surmount.experiment.config import ExperimentConfig, config_class
from surmount.learn.config import LearnerConfig
from surmount.learn.rollout_config import RolloutConfig
from surmount.teachers.advancement import AdvancementConfig

PRESETS = ("smoke", "paper")
SMOKE_PERCENT = 20
"""Share of the paper's: enough to learn to drive, not to master the obstacle. Of 15, 20 and 30 the
first at which the demo's analysis finds more than one group, whatever the arms then did."""


def preset(task: str, name: str) -> ExperimentConfig:
    """Return the configuration of a family of tasks at a scale.

    ``paper`` follows the paper's section III, with five networks instead of two. ``smoke`` runs
    every stage on a fraction of the steps and trials, to show the method at work and to test it;
    its results say nothing about the method's merit.

    Raises
    ------
    ConfigError
        If the task or the preset is unknown.
    """
    if name not in PRESETS:
        raise ConfigError(f"Unknown preset `{name}`.", remedy=nearest(name, [*PRESETS]))
    family = find_family(task)
    experiment = config_class(family.settings)
    if name == "paper":
        return experiment(task=family.name, preset=name, initial_steps=family.initial_steps)
    return experiment(
        task=family.name,
        preset=name,
        networks=2,
        initial_steps=SMOKE_PERCENT * family.initial_steps // 100,
        checkpoint_steps=20_000,
        learner=LearnerConfig(rollout_steps=512, batch_size=512, epochs=6),
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
