"""Charts of an analysis and of a curriculum, by the names that their ``plot`` methods ask for."""

from __future__ import annotations

from pathlib import Path

import altair as alt

from surmount.analysis.result import Analysis
from surmount.core.errors import InputError
from surmount.report.figures.curriculum import curriculum_chart
from surmount.report.figures.fit import fit_chart
from surmount.report.figures.grouping import dendrogram_chart, distance_chart
from surmount.report.figures.stability import stability_chart, success_chart
from surmount.report.pages import write_analysis_report
from surmount.tasks.curriculum import Curriculum
from surmount.trials.trials import Trials


def dendrogram(analysis: Analysis) -> alt.ConcatChart:
    """Draw how the variants join, their groups, and the cut."""
    return dendrogram_chart(analysis)


def distances(analysis: Analysis) -> alt.ConcatChart:
    """Draw the Hellinger distances of every two variants."""
    return distance_chart(analysis)


def success(analysis: Analysis) -> alt.ConcatChart:
    """Draw success on each variant."""
    return success_chart(analysis)


def stability(analysis: Analysis) -> alt.ConcatChart:
    """Draw how often every two variants were in one group when trials were drawn again."""
    if analysis.stability is None:
        raise InputError(
            "How sure the grouping is was not assessed: `bootstrap` is 0.",
            remedy="Analyse again with AnalysisConfig(bootstrap=100).",
        )
    return stability_chart(analysis, analysis.stability)


def fit(analysis: Analysis, variant: float | str | None, trials: Trials | None) -> alt.ConcatChart:
    """Draw recorded points beside points drawn from the mixture of a variant."""
    return fit_chart(analysis, variant, trials)


def curriculum(of: Curriculum) -> alt.ConcatChart:
    """Draw the success of each group, and what each level draws."""
    return curriculum_chart(of)


def report(analysis: Analysis, folder: Path) -> Path:
    """Write the page of an analysis."""
    return write_analysis_report(analysis.to_record(), folder)
