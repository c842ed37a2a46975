"""The comparison of both arms as ``statistics.json`` has it, back in the records of the tests."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from surmount.core.reading import read_as
from surmount.stats.differences import NetworkDifference
from surmount.stats.evidence import SeedInterval
from surmount.stats.logrank import LogRank
from surmount.stats.mixed import Interaction, MethodContrast
from surmount.stats.proportions import ProportionTest
from surmount.stats.survival import KaplanMeier
from surmount.stats.thresholds import StepsToThreshold
from surmount.workflow.run_folder import Record


@dataclass(frozen=True, kw_only=True)
class Success:
    """Successes among trials."""

    successes: int
    trials: int

    @property
    def rate(self) -> float | None:
        """Share of successes; ``None`` without trials."""
        return self.successes / self.trials if self.trials else None


@dataclass(frozen=True, kw_only=True)
class VariantSuccess(Success):
    """Success on one variant with Wilson's interval."""

    variant: tuple[float, ...]
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, eq=False)
class GroupComparison:
    """Both arms in one group.

    Attributes
    ----------
    group
        Name of the group.
    arms
        Success by arm.
    proportion_test, log_rank
        Of equal success rates and of equal completion times.
    survival
        Curve of the trials not finished yet, by arm.
    """

    group: str
    arms: Mapping[str, Success]
    proportion_test: ProportionTest
    survival: Mapping[str, KaplanMeier]
    log_rank: LogRank


@dataclass(frozen=True, kw_only=True)
class PathComparison:
    """Path lengths of one feature over successful trials, by a linear mixed model.

    Attributes
    ----------
    contrasts
        Curriculum minus control in each group.
    interaction
        Whether this difference is the same in all groups; ``None`` without a model.
    degrees_of_freedom_rule
        How degrees of freedom were found; empty without a model.
    singular_note
        What is to be known where the variance between networks is estimated as zero.
    reason
        Why there is no model, if there is none.
    """

    contrasts: tuple[MethodContrast, ...]
    interaction: Interaction | None = None
    degrees_of_freedom_rule: str = ""
    singular_note: str | None = None
    reason: str | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison:
    """All of ``statistics.json``.

    Attributes
    ----------
    cap_s
        Time after which a trial ends as failed, in s.
    by_variant
        Success by what had been learnt (initiation and both arms) and variant, ascending.
    groups
        From easy to difficult.
    path_lengths
        By feature.
    interquartile_mean
        Of the success rates over networks, by arm.
    mean_difference
        Curriculum minus control by the paired t-test on network means.
    difference, probability_of_improvement
        Curriculum against control, over networks, by bootstrap.
    steps_to_95
        By arm, when each group's training episodes succeeded in 95 % of cases.
    """

    cap_s: float
    by_variant: Mapping[str, tuple[VariantSuccess, ...]]
    groups: tuple[GroupComparison, ...]
    path_lengths: Mapping[str, PathComparison]
    interquartile_mean: Mapping[str, SeedInterval]
    mean_difference: NetworkDifference
    difference: SeedInterval
    probability_of_improvement: SeedInterval
    steps_to_95: Mapping[str, tuple[StepsToThreshold, ...]]


def comparison_of(record: Record) -> Comparison:
    """Build from the JSON form; a ``ValueError`` or ``KeyError`` tells of another version."""
    return read_as(
        Comparison,
        {
            **record,
            **record["networks"],
            "by_variant": record["success_by_variant"],
            "groups": record["groups_compared"],
        },
    )
