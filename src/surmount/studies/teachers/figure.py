"""The figure of a comparison: paired differences to uniform tasks, task by task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import plotly.graph_objects as go

from surmount.report.document.parts import Figure, Panel, StillFigure
from surmount.report.figures.palette import INK
from surmount.report.figures.plots import compact, plain, plot
from surmount.report.figures.stills import axes_grid

AXIS = "mean success, difference to uniform tasks (points)"
Record = Mapping[str, Any]


def differences_figure(tasks: Sequence[Record]) -> Figure | None:
    """Return the figure; ``None`` where nothing can be compared yet.

    Parameters
    ----------
    tasks
        Of the record of a comparison.
    """
    rows = [
        (task["title"], teacher["title"], found["mean"])
        for task in tasks
        for teacher in task["teachers"]
        if (found := teacher["against"]) is not None and found["mean"]["lower"] is not None
    ]
    if not rows:
        return None
    names = list(dict.fromkeys(task for task, _, _ in rows))
    return Figure(
        name="teachers-differences",
        label="",
        title="Paired differences to uniform tasks",
        caption=("Mean over networks with its bootstrap interval; networks are paired.",),
        alternative="Points with intervals, one per teacher, a panel per task.",
        legend=(),
        panels=tuple(_panel(name, [row for row in rows if row[0] == name]) for name in names),
        panel_width_px=420,
        still=lambda: _still(names, rows),
        data={
            "task": [task for task, _, _ in rows],
            "teacher": [teacher for _, teacher, _ in rows],
            **{end: [100 * mean[end] for _, _, mean in rows]
               for end in ("estimate", "lower", "upper")},
        },
    )  # fmt: skip


def _panel(name: str, rows: Sequence[tuple[str, str, Record]]) -> Panel:
    chart = plot(x_title=AXIS, y_title="")
    means = [mean for _, _, mean in rows[::-1]]
    chart.add_trace(
        go.Scatter(
            x=compact([100 * mean["estimate"] for mean in means]),
            y=[plain(teacher) for _, teacher, _ in rows[::-1]],
            mode="markers",
            marker={"color": INK, "size": 9},
            error_x={
                "type": "data",
                "array": compact([100 * (mean["upper"] - mean["estimate"]) for mean in means]),
                "arrayminus": compact([100 * (mean["estimate"] - mean["lower"]) for mean in means]),
                "color": INK,
            },
        )
    )
    chart.add_vline(x=0, line_color=INK, line_width=1)
    return Panel(plot=chart, height_px=120 + 34 * len(rows), title=name)


def _still(names: Sequence[str], rows: Sequence[tuple[str, str, Record]]) -> StillFigure:
    tallest = max(sum(row[0] == name for row in rows) for name in names)
    figure, axes = axes_grid(len(names), 1, height_in=0.9 + 0.26 * tallest)
    for axis, name in zip(axes, names, strict=True):
        own = [row for row in rows if row[0] == name][::-1]
        estimates = [100 * mean["estimate"] for _, _, mean in own]
        ends = [
            [100 * (mean["estimate"] - mean["lower"]) for _, _, mean in own],
            [100 * (mean["upper"] - mean["estimate"]) for _, _, mean in own],
        ]
        axis.errorbar(estimates, range(len(own)), xerr=ends, fmt="o", color=INK)
        axis.axvline(0, color=INK, linewidth=0.8)
        axis.set_yticks(range(len(own)), [teacher for _, teacher, _ in own])
        axis.set_title(name)
        axis.set_xlabel(AXIS)
    return figure
