"""The page of an analysis by itself: groups, levels, and every reason for them."""

from __future__ import annotations

from surmount.analysis.explanation import describe_rule, link_table
from surmount.analysis.result import Analysis
from surmount.analysis.trust import describe_trust
from surmount.report.document.parts import Column, Document, Fold, Paragraph, Section, Table
from surmount.report.document.text import axis_label, integer, listed
from surmount.report.sections.grouping import grouping_section
from surmount.report.sections.summary import grouping_sentence, level_sentence

WORDS = 2
"""Columns of the table of links that hold words; the others hold numbers."""


def document_of_analysis(analysis: Analysis) -> Document:
    """Lay out the page of an analysis of any trials."""
    names = listed([axis_label(name) for name in analysis.parameters])
    return Document(
        title=f"A curriculum over {names}",
        subtitle="Determined from logged trials, and how far to trust it",
        notices=(),
        summary=(grouping_sentence(analysis), level_sentence(analysis), *describe_trust(analysis)),
        facts=(
            ("variants", integer(analysis.variants.shape[0])),
            ("trials", integer(int(analysis.n_trials.sum()))),
            ("networks", integer(analysis.n_networks)),
            ("control steps", integer(int(analysis.n_recorded.sum()))),
            ("features", integer(len(analysis.features.names))),
            ("components", integer(max(mixture.n_components for mixture in analysis.mixtures))),
        ),
        sections=(grouping_section(analysis), _evidence(analysis)),
    )


def _evidence(analysis: Analysis) -> Section:
    header, rows = link_table(analysis)
    links = Table(
        label="",
        title="Links of the dendrogram, lowest first",
        columns=tuple(
            Column(heading=name, numeric=index >= WORDS) for index, name in enumerate(header)
        ),
        rows=tuple(tuple(row) for row in rows),
    )
    rule = describe_rule(analysis)
    blocks = (
        Paragraph(text=f"Linkage: {analysis.config.linkage}. {rule[0].upper()}{rule[1:]}"),
        Fold(summary="Link by link", blocks=(links,)),
    )
    return Section(anchor="evidence", title="The evidence", blocks=blocks)
