"""Figure 8, second part: Kaplan–Meier curves of the completion time per group."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
from matplotlib.axes import Axes
from matplotlib.figure import Figure as StillFigure

from surmount.core.arrays import FloatArray
from surmount.report.comparison import Comparison, GroupComparison
from surmount.report.document.parts import Columns, Figure, Panel
from surmount.report.document.text import number, p_value, short
from surmount.report.figures.palette import ARM_STYLES, arm_lines, translucent
from surmount.report.figures.plots import annotate, compact, hover, plot
from surmount.report.figures.stills import axes_grid
from surmount.stats.survival import KaplanMeier
from surmount.workflow.run_layout import ARMS

Steps = tuple[FloatArray, FloatArray]


def survival_curves(comparison: Comparison) -> Figure:
    """Draw the share of trials not finished yet over time, with intervals (paper fig. 8)."""
    return Figure(
        name="figure-8b-survival",
        label="Figure 8b",
        title="Share of trials not finished yet",
        caption=(
            (
                f"Kaplan–Meier curves with 95 % intervals; failed trials are censored at "
                f"{comparison.cap_s:g} s. A curve that falls sooner and deeper is better."
            ),
            "p: log-rank test of equal completion times, curriculum against control (III-E).",
        ),
        alternative="Survival curves per group, curriculum against control: "
        + "; ".join(f"{entry.group}: {log_rank_text(entry)}" for entry in comparison.groups)
        + ".",
        legend=arm_lines(ARMS),
        panels=tuple(
            Panel(plot=_panel(entry, comparison.cap_s), height_px=290, title=entry.group)
            for entry in comparison.groups
        ),
        panel_width_px=290,
        still=lambda: _still(comparison),
        data=_data(comparison),
    )


def log_rank_text(entry: GroupComparison) -> str:
    """Return the log-rank test of one group in a few words."""
    test = entry.log_rank
    if test.statistic is None:
        return "no test possible"
    return f"log-rank χ² = {number(test.statistic)}, {p_value(test.p_value)}"


def _curve(curve: KaplanMeier, cap_s: float) -> Steps:
    """Return corners of the curve from 0 to the cap, to be joined by steps."""
    time = np.concatenate([[0.0], curve.time, [max(cap_s, float(curve.time[-1]))]])
    return time, np.concatenate([[1.0], curve.survival, curve.survival[-1:]])


def _limits(curve: KaplanMeier, cap_s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return times, lower and upper limits; where undefined the curve itself, which is 0 there."""
    time, _ = _curve(curve, cap_s)
    survival = curve.survival.tolist()
    both: list[FloatArray] = []
    for limit in (curve.lower, curve.upper):
        values = [
            value if limited is None else limited
            for limited, value in zip(limit, survival, strict=True)
        ]
        both.append(np.array([1.0, *values, values[-1]]))
    return time, both[0], both[1]


def _panel(entry: GroupComparison, cap_s: float) -> go.Figure:
    figure = plot(x_title="time (s)", y_title="share not finished")
    for arm in ARMS:
        style, curve = ARM_STYLES[arm], entry.survival[arm]
        time, lower, upper = _limits(curve, cap_s)
        for values, fill in ((upper, None), (lower, "tonexty")):
            figure.add_trace(
                go.Scatter(
                    x=compact(time),
                    y=compact(values),
                    mode="lines",
                    line={"width": 0, "shape": "hv"},
                    fill=fill,
                    fillcolor=translucent(style.colour, 0.15),
                    hoverinfo="skip",
                )
            )
        corner, survival = _curve(curve, cap_s)
        at_risk = [curve.n_trials, *curve.at_risk.tolist(), None]
        figure.add_trace(
            go.Scatter(
                x=compact(corner),
                y=compact(survival),
                mode="lines",
                line={"color": style.colour, "width": 2.2, "dash": style.dash, "shape": "hv"},
                hovertext=[
                    hover(
                        f"{style.name}, {at:.1f} s: {100 * value:.1f} % not finished",
                        *([] if risk is None else [f"{risk} at risk just before"]),
                    )
                    for at, value, risk in zip(
                        corner.tolist(), survival.tolist(), at_risk, strict=True
                    )
                ],
                hoverinfo="text",
            )
        )
    annotate(
        figure,
        log_rank_text(entry),
        x=0.99,
        y=1.0,
        xref="paper",
        yref="paper",
        xanchor="right",
        yanchor="top",
    )
    figure.update_xaxes(range=[0, cap_s])
    figure.update_yaxes(range=[0, 1.16], tickvals=[0, 0.25, 0.5, 0.75, 1], tickformat=".0%")
    return figure


def _still(comparison: Comparison) -> StillFigure:
    count = len(comparison.groups)
    columns = min(3, count)
    rows = -(-count // columns)
    figure, axes = axes_grid(rows, columns, height_in=2.2 * rows + 0.4, used=count, share_y=True)
    for index, (entry, ax) in enumerate(zip(comparison.groups, axes, strict=True)):
        _draw(ax, entry, comparison.cap_s)
        if index % columns == 0:
            ax.set_ylabel("share not finished")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=2)
    return figure


def _draw(ax: Axes, entry: GroupComparison, cap_s: float) -> None:
    for arm in ARMS:
        style, curve = ARM_STYLES[arm], entry.survival[arm]
        time, lower, upper = _limits(curve, cap_s)
        ax.fill_between(time, lower, upper, step="post", color=style.colour, alpha=0.15, lw=0)
        corner, survival = _curve(curve, cap_s)
        ax.step(corner, survival, where="post", color=style.colour, ls=style.line, label=style.name)
    ax.set_title(f"{short(entry.group)}\n{log_rank_text(entry)}", fontsize=7.5)
    ax.set_xlim(0, cap_s)
    ax.set_ylim(0, 1.05)
    ax.set_yticks([0, 0.25, 0.5, 0.75, 1.0], ["0 %", "25 %", "50 %", "75 %", "100 %"])
    ax.set_xlabel("time (s)")
    ax.grid(visible=True)


def _data(comparison: Comparison) -> Columns:
    names = ("time", "at_risk", "events", "censored", "survival", "lower", "upper")
    columns: dict[str, list[object]] = {name: [] for name in ("group", "arm", *names)}
    for entry in comparison.groups:
        for arm in ARMS:
            curve = entry.survival[arm]
            rows = curve.time.size
            columns["group"] += [entry.group] * rows
            columns["arm"] += [arm] * rows
            for name in names:
                values = getattr(curve, name)
                columns[name] += values.tolist() if isinstance(values, np.ndarray) else [*values]
    return {"time_s" if name == "time" else name: column for name, column in columns.items()}
