"""The evidence of a run: what both arms show over networks, and a paper's claims one by one.

A finished run keeps it as the artefact of its last stage. Of one that is not finished it is found
anew, as far as the run has come.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from surmount.analysis.result import Analysis
from surmount.core.errors import ConfigError
from surmount.envs.family import TaskFamily
from surmount.envs.registry import find_family
from surmount.report.comparison import Comparison
from surmount.report.outcomes import Outcomes
from surmount.report.verdicts import Claim
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.profile import THRESHOLDS, PerformanceProfile, performance_profile
from surmount.workflow.run_layout import ARMS, SCHEMA

STRATUM = "networks"
"""A run has one task, and so one stratum."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Findings:
    """What evidence is drawn from; what a run has not finished is absent.

    Attributes
    ----------
    analysis
        From trials to curriculum.
    comparison
        Of both arms.
    tests
        Outcomes of trials by what had been trained.
    """

    analysis: Analysis | None
    comparison: Comparison | None
    tests: Mapping[str, Outcomes]


@dataclass(frozen=True, kw_only=True, eq=False)
class Evidence:
    """What is concluded from a run's findings.

    Attributes
    ----------
    profiles
        Performance profile of each arm (Agarwal et al. 2021); empty before both were tested.
    claims
        Of the paper on this task; empty where it has none.
    """

    profiles: Mapping[str, PerformanceProfile]
    claims: tuple[Claim, ...]

    @classmethod
    def of(cls, family: TaskFamily | None, findings: Findings) -> Evidence:
        """Draw it from the findings of a run on a family of tasks."""
        tested = all(arm in findings.tests for arm in ARMS)
        return cls(
            profiles={arm: _profile(findings.tests[arm]) for arm in ARMS} if tested else {},
            claims=() if family is None else tuple(family.claims(findings)),
        )

    def to_record(self) -> dict[str, Any]:
        """Return the JSON form."""
        return {
            "schema": SCHEMA,
            "profiles": {arm: profile.to_record() for arm, profile in self.profiles.items()},
            "claims": [claim.to_record() for claim in self.claims],
        }


def family_of(task: str) -> TaskFamily | None:
    """Return the registered family of a run's task; ``None`` for one's own environment.

    Its module is not imported for a page, nor need it be at hand.
    """
    if ":" in task:
        return None
    try:
        return find_family(task)
    except ConfigError:  # of a package that is not installed here
        return None


def _profile(outcomes: Outcomes) -> PerformanceProfile:
    return performance_profile({STRATUM: outcomes.scores()}, THRESHOLDS, Bootstrap(seed=0))
