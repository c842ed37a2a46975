"""The contents of a run's page, in reading order."""

from __future__ import annotations

from surmount.report.document.parts import Document, Section
from surmount.report.evidence import family_of
from surmount.report.results import RunResults
from surmount.report.sections.evidence import evidence_section
from surmount.report.sections.film import film_section
from surmount.report.sections.grouping import grouping_section
from surmount.report.sections.learning import learning_section
from surmount.report.sections.provenance import provenance_section
from surmount.report.sections.summary import facts, notices, one_group_notice, summary
from surmount.report.sections.testing import testing_section


def document_of(results: RunResults) -> Document:
    """Lay out the page of a run."""
    folder, comparison = results.folder, results.comparison
    family = family_of(folder.task)
    sections: list[Section | None] = [
        grouping_section(results.analysis),
        learning_section(results),
        testing_section(results.analysis, comparison, results.tests),
        evidence_section(results.analysis, comparison, results.evidence),
        film_section(results.films),
        *([] if family is None else family.page_sections(results)),
        provenance_section(folder),
    ]
    return Document(
        title=folder.task if family is None else family.title,
        subtitle="A curriculum determined from the learner's own behaviour, and what it was worth",
        notices=(*notices(folder), *one_group_notice(results.analysis)),
        summary=tuple(summary(results)),
        facts=facts(results),
        sections=tuple(section for section in sections if section is not None),
    )
