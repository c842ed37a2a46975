"""Success over the size of the obstacle: after the initiation, with curriculum and without."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
from matplotlib.figure import Figure as StillFigure

from surmount.report.comparison import Comparison, VariantSuccess
from surmount.report.document.parts import Columns, Figure, LegendEntry, Panel
from surmount.report.document.text import (
    axis_label,
    integer,
    percent,
    percent_interval,
    short,
    variant_label,
)
from surmount.report.figures.palette import ARM_STYLES, group_colour, translucent
from surmount.report.figures.plots import annotate, hover, plain, plot
from surmount.report.figures.stills import axes_grid
from surmount.tasks.curriculum import Curriculum
from surmount.workflow.run_layout import TRAININGS

Spans = list[tuple[float, float, int]]
"""Where groups lie along the axis: from, to, and the group."""


def success_by_variant(comparison: Comparison, curriculum: Curriculum) -> Figure:
    """Draw success on each variant with Wilson's intervals."""
    spans = _spans(curriculum) if len(curriculum.parameters) == 1 else []
    groups = tuple(
        LegendEntry(text=f"group: {group.name}", colour=group_colour(index), shape="square")
        for index, group in enumerate(curriculum.groups)
        if spans
    )
    return Figure(
        name="figure-10-success-by-variant",
        label="Figure 10",
        title="Success on every variant",
        caption=(
            "Share of trials of all networks that succeeded on each variant; bands are 95 % Wilson "
            "intervals over trials. The strip above shows the groups."
            if spans
            else "Share of trials of all networks that succeeded on each variant, in ascending "
            "order; bands are 95 % Wilson intervals over trials.",
        ),
        alternative="Curves of success over the variants for initiation, curriculum and control, "
        "with intervals.",
        legend=(
            *(
                LegendEntry(
                    text=ARM_STYLES[kind].name,
                    colour=ARM_STYLES[kind].colour,
                    shape={"circle": "circle", "diamond": "diamond"}.get(  # type: ignore[arg-type]
                        ARM_STYLES[kind].marker, "square"
                    ),
                )
                for kind in TRAININGS
            ),
            *groups,
        ),
        panels=(Panel(plot=_panel(comparison, curriculum, spans), height_px=340),),
        panel_width_px=340,
        still=lambda: _still(comparison, curriculum, spans),
        data=_data(comparison, curriculum),
    )


def _spans(curriculum: Curriculum) -> Spans:
    return sorted(
        (float(box.lower[0]), float(box.upper[0]), index)
        for index, group in enumerate(curriculum.groups)
        for box in group.boxes
    )


def _positions(rows: tuple[VariantSuccess, ...]) -> list[float]:
    """Return where variants stand: at their size, or in a row where they have several."""
    if rows and len(rows[0].variant) == 1:
        return [row.variant[0] for row in rows]
    return [float(index) for index in range(len(rows))]


def _title(curriculum: Curriculum) -> str:
    if len(curriculum.parameters) == 1:
        return axis_label(curriculum.parameters[0])
    return f"variant ({', '.join(curriculum.parameters)})"


def _panel(comparison: Comparison, curriculum: Curriculum, spans: Spans) -> go.Figure:
    figure = plot(x_title=_title(curriculum), y_title="share of trials that succeed")
    for low, high, group in spans:
        figure.add_shape(
            type="rect",
            x0=low,
            x1=high,
            y0=1.05,
            y1=1.12,
            fillcolor=translucent(group_colour(group), 0.75),
            line={"width": 0},
            layer="below",
        )
        annotate(
            figure,
            short(curriculum.groups[group].name),
            x=(low + high) / 2,
            y=1.085,
            yanchor="middle",
            captureevents=False,
        )
    for kind in TRAININGS:
        _add_curve(figure, kind, comparison.by_variant[kind])
    figure.update_yaxes(range=[-0.02, 1.14], tickvals=[0, 0.25, 0.5, 0.75, 1], tickformat=".0%")
    if not spans:
        rows = comparison.by_variant[TRAININGS[0]]
        figure.update_xaxes(
            tickvals=_positions(rows), ticktext=[plain(variant_label(row.variant)) for row in rows]
        )
    return figure


def _add_curve(figure: go.Figure, kind: str, rows: tuple[VariantSuccess, ...]) -> None:
    style, x = ARM_STYLES[kind], _positions(rows)
    figure.add_trace(
        go.Scatter(
            x=[*x, *reversed(x)],
            y=[*(row.upper for row in rows), *(row.lower for row in reversed(rows))],
            mode="lines",
            line={"width": 0},
            fill="toself",
            fillcolor=translucent(style.colour, 0.15),
            hoverinfo="skip",
        )
    )
    figure.add_trace(
        go.Scatter(
            x=x,
            y=[row.rate for row in rows],
            mode="lines+markers",
            line={"color": style.colour, "width": 2, "dash": style.dash},
            marker={"symbol": style.marker, "size": 8, "color": style.colour},
            hovertext=[
                hover(
                    f"{variant_label(row.variant)}, {style.name}",
                    f"{integer(row.successes)} of {integer(row.trials)}: {percent(row.rate, 1)}",
                    f"95 % interval {percent_interval(row.lower, row.upper, 1)}",
                )
                for row in rows
            ],
            hoverinfo="text",
        )
    )


def _still(comparison: Comparison, curriculum: Curriculum, spans: Spans) -> StillFigure:
    figure, (ax,) = axes_grid(1, 1, height_in=2.9)
    for low, high, group in spans:
        ax.fill_between([low, high], 1.05, 1.13, color=group_colour(group), alpha=0.75, lw=0)
        name = short(curriculum.groups[group].name)
        ax.text((low + high) / 2, 1.087, name, ha="center", va="center", fontsize=7)
    for kind in TRAININGS:
        style, rows = ARM_STYLES[kind], comparison.by_variant[kind]
        x = _positions(rows)
        lower, upper = [row.lower for row in rows], [row.upper for row in rows]
        rates = [np.nan if row.rate is None else row.rate for row in rows]
        ax.fill_between(x, lower, upper, color=style.colour, alpha=0.15, lw=0)
        ax.plot(x, rates, style.point, ls=style.line, color=style.colour, ms=4, label=style.name)
    if not spans:
        rows = comparison.by_variant[TRAININGS[0]]
        ax.set_xticks(_positions(rows), [variant_label(row.variant) for row in rows], rotation=90)
    ax.set_ylim(-0.03, 1.15)
    ax.set_yticks([0, 0.25, 0.5, 0.75, 1.0], ["0 %", "25 %", "50 %", "75 %", "100 %"])
    ax.set_xlabel(_title(curriculum))
    ax.set_ylabel("share of trials that succeed")
    ax.grid(visible=True)
    handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=3)
    return figure


def _data(comparison: Comparison, curriculum: Curriculum) -> Columns:
    names = [f"variant.{name}" for name in curriculum.parameters]
    columns: dict[str, list[object]] = {
        name: []
        for name in ("stage", *names, "group", "successes", "trials", "rate", "lower", "upper")
    }
    for kind in TRAININGS:
        for row in comparison.by_variant[kind]:
            group = curriculum.group_of(np.asarray(row.variant))
            values = (kind, *row.variant, None if group is None else curriculum.groups[group].name,
                      row.successes, row.trials, row.rate,
                      row.lower, row.upper)  # fmt: skip
            for column, value in zip(columns.values(), values, strict=True):
                column.append(value)
    return columns
