"""The page of an analysis by itself: groups, levels, and every reason for them."""

from __future__ import annotations

from collections.abc import Sequence

from surmount.analysis import Analysis, describe_trust
from surmount.analysis.explanation import describe_rule, link_table
from surmount.report.document import Column, Document, Fold, Paragraph, Section, Table
from surmount.report.grouping_section import grouping_section
from surmount.report.summary import grouping_sentence, level_sentence
from surmount.report.text import axis_label, integer, listed


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
    links = _table("Links of the dendrogram, lowest first", header, rows, words=2)
    rule = describe_rule(analysis)
    blocks: list[Fold | Table | Paragraph] = [
        Paragraph(text=f"Linkage: {analysis.config.linkage}. {rule[0].upper()}{rule[1:]}"),
        Fold(summary="Link by link", blocks=(links,)),
    ]
    return Section(anchor="evidence", title="The evidence", blocks=tuple(blocks))


def _table(
    title: str,
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    words: int,
    notes: tuple[str, ...] = (),
) -> Table:
    """Return a table whose first columns hold words, the others numbers."""
    return Table(
        label="",
        title=title,
        columns=tuple(
            Column(heading=name, numeric=index >= words) for index, name in enumerate(header)
        ),
        rows=tuple(tuple(row) for row in rows),
        notes=notes,
    )
