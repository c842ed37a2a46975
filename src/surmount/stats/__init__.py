"""The paper's statistics (III-E) and intervals over seeds."""

from __future__ import annotations

from surmount.stats.bootstrap import Bootstrap
from surmount.stats.detectable import (
    DetectableDifference,
    NetworksNeeded,
    detectable_difference,
    networks_needed,
    paired_power,
)
from surmount.stats.differences import NetworkDifference, network_difference
from surmount.stats.evidence import (
    SeedInterval,
    bootstrap_interval,
    difference_interval,
    interquartile_mean,
    probability_of_improvement,
)
from surmount.stats.logrank import LogRank, log_rank
from surmount.stats.mixed import (
    CellMean,
    Interaction,
    MethodContrast,
    MixedModel,
    NetworkContrast,
    mixed_model,
    network_contrasts,
)
from surmount.stats.profile import PerformanceProfile, performance_profile
from surmount.stats.proportions import (
    ProportionIntervals,
    ProportionTest,
    proportion_intervals,
    proportion_test,
)
from surmount.stats.result import JsonValue, Result
from surmount.stats.survival import KaplanMeier, kaplan_meier
from surmount.stats.thresholds import StepsToThreshold, steps_to_threshold

__all__ = [
    "Bootstrap",
    "CellMean",
    "DetectableDifference",
    "Interaction",
    "JsonValue",
    "KaplanMeier",
    "LogRank",
    "MethodContrast",
    "MixedModel",
    "NetworkContrast",
    "NetworkDifference",
    "NetworksNeeded",
    "PerformanceProfile",
    "ProportionIntervals",
    "ProportionTest",
    "Result",
    "SeedInterval",
    "StepsToThreshold",
    "bootstrap_interval",
    "detectable_difference",
    "difference_interval",
    "interquartile_mean",
    "kaplan_meier",
    "log_rank",
    "mixed_model",
    "network_contrasts",
    "network_difference",
    "networks_needed",
    "paired_power",
    "performance_profile",
    "probability_of_improvement",
    "proportion_intervals",
    "proportion_test",
    "steps_to_threshold",
]
