"""All kinds of stages: the word that keys hold for each, and the function behind it.

A kind keeps its name wherever its function moves and whatever it is called. Its ``legacy`` name is
frozen: it is where the function stood when keys still held ``module:function``, below
``surmount.experiment``, and finds what runs of that time finished (ADR 1).
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from surmount.experiment import stages
from surmount.experiment.evidence import weigh
from surmount.experiment.statistics import compare
from surmount.experiment.teacher_statistics import compare_teachers
from surmount.workflow.graph import StageFunction, StageKind


def _known(name: str, function: StageFunction, was: str, version: int = 1) -> StageKind:
    """Return a kind that had stages before there were kinds."""
    legacy = f"surmount.experiment.{was}"
    return StageKind(name=name, function=function, version=version, legacy=legacy)


INITIATION = _known("initiation", stages.initiate, "stages:initiate")
TRIALS = _known("trials", stages.run_trials, "stages:run_trials", version=2)
JOIN_TRIALS = _known("join-trials", stages.join_trials, "stages:join_trials")
ANALYSIS = _known("analysis", stages.analyse, "stages:analyse", version=3)
CURRICULUM = _known("curriculum", stages.learn_levels, "stages:learn_levels")
CONTROL = _known("control", stages.learn_control, "stages:learn_control")
STATISTICS = _known("statistics", compare, "statistics:compare", version=2)
EVIDENCE = StageKind(name="evidence", function=weigh)
TEACHER = _known("teacher", stages.learn_by_teacher, "teaching:learn_by_teacher")
TEACHER_STATISTICS = _known(
    "teacher-statistics", compare_teachers, "teacher_statistics:compare_teachers"
)

KINDS: Mapping[str, StageKind] = MappingProxyType(
    {
        kind.name: kind
        for kind in (
            INITIATION,
            TRIALS,
            JOIN_TRIALS,
            ANALYSIS,
            CURRICULUM,
            CONTROL,
            STATISTICS,
            EVIDENCE,
            TEACHER,
            TEACHER_STATISTICS,
        )
    }
)
"""Every kind by its name."""
