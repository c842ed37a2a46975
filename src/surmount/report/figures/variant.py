"""Success over the size of the obstacle: after the initiation, with curriculum and without."""

from __future__ import annotations

import altair as alt
import numpy as np

from surmount.analysis.features import describe_variant
from surmount.core.axis import Axes, values_of
from surmount.report.comparison import Comparison, VariantSuccess
from surmount.report.document.parts import Columns, Figure
from surmount.report.document.text import (
    axis_label,
    integer,
    percent,
    percent_interval,
    short,
)
from surmount.report.figures.charts import (
    figure,
    frame,
    layers,
    seen,
    shares,
    styles,
    tick_labels,
    words,
    x_of,
)
from surmount.report.figures.palette import ARM_STYLES, group_series
from surmount.report.figures.variant_matrix import ticks_of
from surmount.tasks.curriculum import Curriculum
from surmount.workflow.run_layout import TRAININGS

HEIGHT_PX = 280
LEAST_PX = 340

Spans = list[tuple[float, float, int]]
"""Where groups lie along the axis: from, to, and the group."""


def success_by_variant(comparison: Comparison, curriculum: Curriculum) -> Figure:
    """Draw success on each variant with Wilson's intervals."""
    spans = _spans(curriculum) if len(curriculum.parameters) == 1 else []
    logarithmic = bool(spans) and curriculum.axes[0].kind == "logarithmic"
    return Figure(
        name="figure-10-success-by-variant",
        label="Figure 10",
        title="Success on every variant",
        caption=(
            "Share of trials of all networks that succeeded on each variant; bands are 95 % Wilson "
            f"intervals over trials.{' The axis is logarithmic.' if logarithmic else ''} The strip "
            "above shows the groups."
            if spans
            else "Share of trials of all networks that succeeded on each variant, in ascending "
            "order; bands are 95 % Wilson intervals over trials.",
        ),
        alternative="Curves of success over the variants for initiation, curriculum and control, "
        "with intervals.",
        chart=figure(
            [_panel(comparison, curriculum, spans)], columns=1, least_px=LEAST_PX, zoom=True
        ),
        data=_data(comparison, curriculum),
    )


def _spans(curriculum: Curriculum) -> Spans:
    """Return where groups lie on the scale of the axis; those that touch are one."""
    (axis,) = curriculum.axes
    found: Spans = []
    for low, high, index in sorted(
        (*(float(side[0]) for side in axis.sides(box.lower, box.upper)), index)
        for index, group in enumerate(curriculum.groups)
        for box in group.boxes
    ):
        begin = found.pop()[0] if found and found[-1][1:] == (low, index) else low
        found.append((begin, high, index))
    return found


def _positions(rows: tuple[VariantSuccess, ...], axes: Axes) -> list[float]:
    """Return where variants stand: on the axis' scale, or in a row where there are several."""
    if len(axes) == 1:
        return axes[0].scale(np.array([row.variant[0] for row in rows])).tolist()
    return [float(index) for index in range(len(rows))]


def _ticks(comparison: Comparison, axes: Axes) -> tuple[list[float], list[str]] | None:
    """Return ticks and their texts; ``None`` where numbers along the axis are the values."""
    if len(axes) == 1 and axes[0].kind in ("continuous", "integer"):
        return None
    rows = comparison.by_variant[TRAININGS[0]]
    shown = ticks_of(len(rows)) if len(axes) == 1 and not axes[0].categorical else range(len(rows))
    places = _positions(rows, axes)
    return [places[i] for i in shown], [describe_variant(rows[i].variant, axes) for i in shown]


def _title(curriculum: Curriculum) -> str:
    if len(curriculum.parameters) == 1:
        return axis_label(curriculum.parameters[0])
    return f"variant ({', '.join(curriculum.parameters)})"


def _panel(comparison: Comparison, curriculum: Curriculum, spans: Spans) -> alt.LayerChart:
    axes, look = curriculum.axes, [ARM_STYLES[kind] for kind in TRAININGS]
    columns: dict[str, list[object]] = {
        name: []
        for name in ("x", "y", "lower", "upper", "series", "variant", "success", "interval")
    }
    for kind in TRAININGS:
        rows = comparison.by_variant[kind]
        for place, row in zip(_positions(rows, axes), rows, strict=True):
            own = (
                *(place, row.rate, row.lower, row.upper, ARM_STYLES[kind].name),
                describe_variant(row.variant, axes),
                f"{integer(row.successes)} of {integer(row.trials)}: {percent(row.rate, 1)}",
                percent_interval(row.lower, row.upper, 1),
            )
            for column, value in zip(columns.values(), own, strict=True):
                column.append(value)
    ticks = _ticks(comparison, axes)
    upright = ticks is not None and len(axes) > 1
    hidden = alt.Axis(labels=False, ticks=False, grid=False,
                      titlePadding=70 if upright else 20)  # fmt: skip
    x = x_of("x", _title(curriculum), axis=alt.Axis(grid=False) if ticks is None else hidden)
    base = alt.Chart(frame(columns)).encode(
        x,
        tooltip=["variant:N", alt.Tooltip("series:N", title="after"), "success:N", "interval:N"],
    )
    return layers(
        base.mark_area(clip=True).encode(
            shares("share of trials that succeed", "lower", top=1.14, bottom=-0.02),
            y2="upper:Q",
            opacity=seen(0.18),
            **styles(look, "color"),
        ),
        base.mark_line(clip=True).encode(
            alt.Y("y:Q"), opacity=seen(), **styles(look, "color", "strokeDash", "shape")
        ),
        base.mark_point(filled=True, size=50, clip=True).encode(
            alt.Y("y:Q"), opacity=seen(), **styles(look, "color", "shape")
        ),
        *_strip(curriculum, spans),
        *([] if ticks is None else [tick_labels(*ticks, HEIGHT_PX, upright=upright)]),
        height=HEIGHT_PX,
    )


def _strip(curriculum: Curriculum, spans: Spans) -> list[alt.Chart]:
    """Return the groups as a strip above the curves."""
    if not spans:
        return []
    low, high, index = zip(*spans, strict=True)
    look = [group_series(i, short(group.name)) for i, group in enumerate(curriculum.groups)]
    rows = {"x": low, "x2": high, "group": [look[i].name for i in index]}
    strip = alt.Chart(frame({**rows, "y": [1.05] * len(low), "y2": [1.12] * len(low)}))
    middles = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
    names = {"x": middles, "y": [1.085] * len(low), "text": rows["group"]}
    return [
        strip.mark_rect(fillOpacity=0.35, strokeWidth=1, clip=True).encode(
            alt.X("x:Q"),
            alt.Y("y:Q"),
            x2="x2:Q",
            y2="y2:Q",
            tooltip="group:N",
            **styles(look, "fill", "stroke", legend=False, field="group"),
        ),
        words(names, baseline="middle", size=10, clip=True),
    ]


def _data(comparison: Comparison, curriculum: Curriculum) -> Columns:
    names = [f"variant.{name}" for name in curriculum.parameters]
    columns: dict[str, list[object]] = {
        name: []
        for name in ("stage", *names, "group", "successes", "trials", "rate", "lower", "upper")
    }
    for kind in TRAININGS:
        for row in comparison.by_variant[kind]:
            group = curriculum.group_of(np.asarray(row.variant))
            values = (kind, *values_of(curriculum.axes, np.asarray(row.variant)),
                      None if group is None else curriculum.groups[group].name,
                      row.successes, row.trials, row.rate,
                      row.lower, row.upper)  # fmt: skip
            for column, value in zip(columns.values(), values, strict=True):
                column.append(value)
    return columns
