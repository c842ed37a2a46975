"""The stage that weighs a run: what both arms show over networks, and the claims of the paper."""

from __future__ import annotations

from surmount.analysis.result import Analysis
from surmount.core.records import read_record, write_record
from surmount.experiment.stages import only
from surmount.experiment.task_part import family_and_settings
from surmount.report.comparison import comparison_of
from surmount.report.evidence import Evidence, Findings
from surmount.report.outcomes import read_outcomes
from surmount.workflow.graph import StageContext
from surmount.workflow.run_layout import (
    ANALYSIS,
    ANALYSIS_FILE,
    EVIDENCE_FILE,
    STATISTICS,
    STATISTICS_FILE,
    TRAININGS,
)


def weigh(context: StageContext) -> None:
    """Write ``evidence.json``: profiles of both arms, and every claim with its verdict."""
    family, _ = family_and_settings(context.config)
    statistics = read_record(only(context, STATISTICS).path(STATISTICS_FILE))
    findings = Findings(
        analysis=Analysis.load(only(context, ANALYSIS).path(ANALYSIS_FILE)),
        comparison=comparison_of(statistics),
        tests={training: read_outcomes(context.inputs[training]) for training in TRAININGS},
    )
    write_record(context.output / EVIDENCE_FILE, Evidence.of(family, findings).to_record())
