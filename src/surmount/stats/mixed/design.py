"""The columns of the mixed model: a response with each row's group, arm and network."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from surmount.core.arrays import FloatArray
from surmount.stats.columns import Labels, Table, column, labels, numbers, require_same_length


@dataclass(frozen=True, kw_only=True, eq=False)
class Design:
    """Columns read and checked, one row per trial.

    Attributes
    ----------
    response
        What is to be explained, shape ``(row,)``.
    group, method, subject
        Each row's group of variants, arm, and initial network.
    """

    response: FloatArray
    group: Labels
    method: Labels
    subject: Labels


def read_design(
    table: Table,
    *,
    response: str,
    group: str,
    method: str,
    subject: str,
    groups: Sequence[object] | None,
    methods: Sequence[object] | None,
) -> Design:
    """Read the columns named, as described in :func:`surmount.stats.mixed_model`."""
    design = Design(
        response=numbers(column(table, response), response),
        group=labels(column(table, group), group, order=groups),
        method=labels(column(table, method), method, order=methods),
        subject=labels(column(table, subject), subject),
    )
    lengths = {
        response: design.response,
        group: design.group.codes,
        method: design.method.codes,
        subject: design.subject.codes,
    }
    require_same_length(**lengths)
    return design
