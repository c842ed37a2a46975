"""The contents of a run's page, in reading order."""

from __future__ import annotations

from surmount.report.document.parts import Document, Section
from surmount.report.results import RunResults
from surmount.report.sections.evidence import evidence_section
from surmount.report.sections.film import film_section
from surmount.report.sections.grouping import grouping_section
from surmount.report.sections.learning import learning_section
from surmount.report.sections.provenance import provenance_section
from surmount.report.sections.summary import facts, notices, summary
from surmount.report.sections.testing import testing_section
from surmount.studies.paper.section import paper_section


def document_of(results: RunResults) -> Document:
    """Lay out the page of a run."""
    folder, comparison = results.folder, results.comparison
    sections: list[Section | None] = [
        grouping_section(results.analysis),
        learning_section(results),
        testing_section(results.analysis, comparison, results.tests),
        evidence_section(results.analysis, comparison, results.tests),
        film_section(results.films),
        paper_section(results),
        provenance_section(folder),
    ]
    return Document(
        title=folder.obstacle
        if ":" in folder.obstacle
        else f"RSTAR and the {folder.obstacle.replace('-', ' ')}",
        subtitle="A curriculum determined from the robot's own behaviour, and what it was worth",
        notices=tuple(notices(folder)),
        summary=tuple(summary(results)),
        facts=facts(results),
        sections=tuple(section for section in sections if section is not None),
    )
