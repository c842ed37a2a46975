"""Presets: the paper's scale, and a small one that runs through in minutes."""

from __future__ import annotations

from dataclasses import replace

from surmount.analysis import AnalysisConfig
from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError
from surmount.envs import OBSTACLES
from surmount.experiment.config import ExperimentConfig
from surmount.learn import LearnerConfig, RolloutConfig
from surmount.own import is_own, source_hash
from surmount.teachers import AdvancementConfig

SCALES = ("smoke", "paper")
INITIAL_STEPS = {"narrow-channel": 500_000, "low-entrance": 500_000, "step": 1_000_000}
"""Learning steps of the initiation (paper III-C)."""
SMOKE_PERCENT = 20
"""Share of the paper's: enough to learn to drive, not to master the obstacle. Of 15, 20 and 30 the
first at which the demo's analysis finds more than one group, whatever the arms then did."""

OWN_INITIAL_STEPS = 500_000
"""For an environment of one's own: as the paper's for two of its three obstacles (assumed)."""


def preset(obstacle: str, scale: str) -> ExperimentConfig:
    """Return the configuration of an obstacle at a scale.

    ``paper`` follows the paper's section III, with five networks instead of two. ``smoke`` runs
    every stage on a fraction of the steps and trials, to show the method at work and to test it;
    its results say nothing about the method's merit.

    Raises
    ------
    ConfigError
        If the obstacle, the function or the scale is unknown.
    """
    if scale not in SCALES:
        raise ConfigError(f"Unknown preset `{scale}`.", remedy=nearest(scale, [*SCALES]))
    if is_own(obstacle):
        sha256 = source_hash(obstacle)
        return replace(_preset(obstacle, scale, OWN_INITIAL_STEPS), own_sha256=sha256)
    if obstacle not in OBSTACLES:
        raise ConfigError(f"Unknown obstacle `{obstacle}`.", remedy=nearest(obstacle, [*OBSTACLES]))
    return _preset(obstacle, scale, INITIAL_STEPS[obstacle])


def _preset(obstacle: str, scale: str, initial_steps: int) -> ExperimentConfig:
    if scale == "paper":
        return ExperimentConfig(obstacle=obstacle, scale=scale, initial_steps=initial_steps)
    return ExperimentConfig(
        obstacle=obstacle,
        scale=scale,
        networks=2,
        initial_steps=SMOKE_PERCENT * initial_steps // 100,
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
