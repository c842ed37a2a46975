"""Numbers between every two variants as a heat map, with the groups framed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import altair as alt
import numpy as np

from surmount.analysis.result import Analysis
from surmount.core.arrays import FloatArray
from surmount.report.document.text import axis_label, short
from surmount.report.figures.charts import frame, layers, styles
from surmount.report.figures.palette import SEQUENTIAL, Series, group_series


def matrix_panel(
    analysis: Analysis,
    values: FloatArray,
    words: Callable[[float], str],
    *,
    height: int,
    title: str,
    series: Sequence[Series] = (),
    likeness: bool = False,
) -> alt.LayerChart:
    """Return a heat map of values from 0 to 1, shape ``(variant, variant)``.

    Parameters
    ----------
    analysis
        The analysis whose variants and groups these are.
    values
        What is drawn.
    words
        A value as the label that appears on hovering tells it.
    height, title
        Of the panel.
    series
        All that the figure tells by colour, where that is more than the groups.
    likeness
        Whether 1 means alike, and is drawn light; else 0 does.
    """
    labels = variant_names(analysis)
    n = len(labels)
    names = [analysis.groups[group].name for group in analysis.labels]
    rows, columns = (side.ravel() for side in np.indices((n, n)))
    cells = frame(
        {
            "row": [labels[i] for i in rows],
            "column": [labels[j] for j in columns],
            "value": values.ravel(),
            "variants": [
                f"{labels[i]} ({short(names[i])}) and {labels[j]} ({short(names[j])})"
                for i, j in zip(rows, columns, strict=True)
            ],
            "told": [words(float(value)) for value in values.ravel()],
        }
    )
    x, y = variant_axis(analysis, alt.X, "column"), variant_axis(analysis, alt.Y, "row")
    heat = (
        alt.Chart(cells)
        .mark_rect()
        .encode(
            x,
            y,
            fill=alt.Fill(
                "value:Q",
                title=None,
                scale=alt.Scale(domain=[0, 1], range=list(_stops(likeness=likeness))),
                legend=None,
            ),
            tooltip=[alt.Tooltip("variants:N"), alt.Tooltip("told:N", title="between them")],
        )
    )
    first, last = zip(*runs(analysis), strict=True)
    frames = (
        alt.Chart(
            frame(
                {
                    "first": [labels[i] for i in first],
                    "last": [labels[i] for i in last],
                    "series": [short(names[i]) for i in first],
                }
            )
        )
        .mark_rect(filled=False, strokeWidth=3)
        .encode(
            variant_axis(analysis, alt.X, "first", bandPosition=0),
            variant_axis(analysis, alt.Y, "first", bandPosition=0),
            x2=alt.X2("last", bandPosition=1),
            y2=alt.Y2("last", bandPosition=1),
            **styles(series or group_styles(analysis), "color"),
        )
    )
    return layers(heat, frames, height=height, title=title).resolve_scale(fill="independent")


def group_styles(analysis: Analysis) -> list[Series]:
    """Return how the groups of an analysis are drawn."""
    return [group_series(i, short(group.name)) for i, group in enumerate(analysis.groups)]


def variant_names(analysis: Analysis) -> list[str]:
    """Return variants as people write them; of two that are written alike the second is marked."""
    found: list[str] = []
    for label in map(short, analysis.labels_of_variants):
        name = label
        while name in found:
            name += "′"
        found.append(name)
    return found


def variant_axis(
    analysis: Analysis, channel: type[alt.X] | type[alt.Y], field: str, **options: Any
) -> alt.X | alt.Y:
    """Return an axis on which the variants stand in a row."""
    labels = variant_names(analysis)
    several = len(analysis.parameters) > 1
    return channel(
        f"{field}:N",
        sort=None,
        title=variant_title(analysis),
        scale=alt.Scale(domain=labels, padding=0),
        axis=alt.Axis(
            values=[labels[i] for i in ticks_of(len(labels))],
            labelAngle=270 if several and channel is alt.X else 0,
            grid=False,
        ),
        **options,
    )


def variant_title(analysis: Analysis) -> str:
    """Return the title of an axis of variants."""
    if len(analysis.parameters) == 1:
        return axis_label(analysis.parameters[0])
    return f"variant: {', '.join(axis_label(name) for name in analysis.parameters)}"


def runs(analysis: Analysis) -> list[tuple[int, int]]:
    """Return first and last index of each run of neighbouring variants of one group."""
    edges = np.flatnonzero(np.diff(analysis.labels)) + 1
    starts = [0, *edges.tolist()]
    return list(zip(starts, [*(edges - 1).tolist(), analysis.labels.size - 1], strict=True))


def ticks_of(n: int) -> list[int]:
    """Return the variants that are labelled: ten at most."""
    step = -(-n // 10)
    return list(range(0, n, step))


def _stops(*, likeness: bool) -> tuple[str, ...]:
    return SEQUENTIAL[::-1] if likeness else SEQUENTIAL
