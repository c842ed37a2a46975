"""An analysis in a few lines, and as HTML for a notebook."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

from surmount.analysis.description import (
    counted,
    describe_curriculum,
    describe_no_levels,
    group_table,
    level_table,
)
from surmount.analysis.trust import describe_trust

if TYPE_CHECKING:
    from surmount.analysis.result import Analysis


def text_of(analysis: Analysis) -> str:
    """Return groups, levels and the verdict in a few lines."""
    size = f"{counted(len(analysis.variants), 'variant')} tried by "
    size += counted(analysis.n_networks, "network")
    lines = [line for line in describe_curriculum(analysis.curriculum) if line]
    return "\n".join([f"Analysis: {size}", *lines, describe_trust(analysis)[0]])


def html_of(analysis: Analysis) -> str:
    """Return the same as two tables between sentences."""
    curriculum = analysis.curriculum
    variants = counted(len(analysis.variants), "variant")
    networks = counted(analysis.n_networks, "network")
    parts = [
        f"<p><b>{escape(describe_trust(analysis)[0])}</b></p>",
        f"<p>{variants} of {escape(', '.join(analysis.parameters))}, tried by {networks}.</p>",
        _table(*group_table(curriculum)),
        _table(*level_table(curriculum))
        if curriculum.levels
        else f"<p>{describe_no_levels(curriculum)}</p>",
    ]
    parts += [f"<p>{escape(warning)}</p>" for warning in analysis.warnings]
    return "\n".join(parts)


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{escape(cell)}</th>" for cell in header)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
