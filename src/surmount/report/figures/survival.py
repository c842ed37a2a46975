"""Figure 8, second part: Kaplan–Meier curves of the completion time per group."""

from __future__ import annotations

import altair as alt
import numpy as np

from surmount.core.arrays import FloatArray
from surmount.report.comparison import Comparison, GroupComparison
from surmount.report.document.parts import Columns, Figure
from surmount.report.document.text import number, p_value, percent, short
from surmount.report.figures.charts import figure, frame, layers, seen, shares, styles, words, x_of
from surmount.report.figures.palette import ARM_STYLES
from surmount.stats.survival import KaplanMeier
from surmount.workflow.run_layout import ARMS

Steps = tuple[FloatArray, FloatArray]

HEIGHT_PX = 210
LEAST_PX = 270


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
        chart=figure(
            [_panel(entry, comparison.cap_s) for entry in comparison.groups],
            columns=3,
            least_px=LEAST_PX,
            zoom=True,
        ),
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


def _panel(entry: GroupComparison, cap_s: float) -> alt.LayerChart:
    columns: dict[str, list[object]] = {
        name: []
        for name in ("x", "y", "lower", "upper", "series", "time", "not finished", "at risk")
    }
    for arm in ARMS:
        curve = entry.survival[arm]
        corner, survival = _curve(curve, cap_s)
        _, lower, upper = _limits(curve, cap_s)
        columns["x"] += corner.tolist()
        columns["y"] += survival.tolist()
        columns["lower"] += lower.tolist()
        columns["upper"] += upper.tolist()
        columns["series"] += [ARM_STYLES[arm].name] * corner.size
        columns["time"] += [f"{at:.1f} s" for at in corner]
        columns["not finished"] += [percent(float(share), 1) for share in survival]
        columns["at risk"] += [curve.n_trials, *curve.at_risk.tolist(), None]
    look = [ARM_STYLES[arm] for arm in ARMS]
    base = alt.Chart(frame(columns)).encode(
        x_of("x", "time (s)", domain=(0, cap_s), axis=alt.Axis(grid=False))
    )
    text = log_rank_text(entry).replace(", ", "\n")
    return layers(
        base.mark_area(interpolate="step-after", clip=True).encode(
            shares("share not finished", "lower", top=1.2),
            y2="upper:Q",
            opacity=seen(0.18),
            **styles(look, "color"),
        ),
        base.mark_line(interpolate="step-after", clip=True).encode(
            alt.Y("y:Q"), opacity=seen(), **styles(look, "color", "strokeDash")
        ),
        base.mark_point(filled=True, size=50, clip=True).encode(
            alt.Y("y:Q"),
            opacity=alt.value(0),
            tooltip=[
                alt.Tooltip("series:N", title="arm"), "time:N", "not finished:N",
                alt.Tooltip("at risk:N", title="at risk just before"),
            ],
        ),
        words({"text": [text]}, x=alt.value("width"), y=alt.value(2), align="right",
              baseline="top", lineBreak="\n", dx=-2),
        height=HEIGHT_PX,
        title=short(entry.group),
    )  # fmt: skip


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
