"""Figure 7: learning curves of every network, with levels and every decision of eq. 5."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import plotly.graph_objects as go
from matplotlib.axes import Axes
from matplotlib.figure import Figure as StillFigure

from surmount.report.document.parts import Figure, LegendEntry, Panel
from surmount.report.document.text import MINUS, counted, integer, number, percent
from surmount.report.figures.curves import (
    Curve,
    Measure,
    Trainings,
    curves_of,
    learning_data,
    levels_of,
    tests_of,
)
from surmount.report.figures.palette import ARM_STYLES, INK, PAPER, arm_lines, translucent
from surmount.report.figures.plots import annotate, compact, hover, plot
from surmount.report.figures.stills import axes_grid
from surmount.teachers.teacher import Decision, LevelTest
from surmount.workflow.run_layout import CURRICULUM, TRAININGS

TITLES = {
    "reward": "mean reward per step",
    "success": "success of episodes",
}
DECISIONS: dict[Decision, tuple[str, str, str, str]] = {
    "extend": ("level extended", "circle", "o", PAPER),
    "advance": ("level passed", "triangle-up", "^", INK),
    "advance at the limit": ("left at the limit of extensions", "square", "s", INK),
}
"""Name, Plotly's symbol, Matplotlib's marker and filling of each decision."""
RARE = 0.02
"""Share of roll-outs that may lie below the panels."""
BAND = "#0072B2"


def learning_curves(trainings: Trainings, measure: Measure) -> Figure | None:
    """Draw the measure over all learning of each network; ``None`` where nothing was learnt."""
    networks = sorted({network for found in trainings.values() for network in found})
    drawn = {network: curves_of(trainings, network, measure) for network in networks}
    drawn = {network: curves for network, curves in drawn.items() if curves}
    if not drawn:
        return None
    bounds = _bounds(drawn, measure)
    panels = tuple(
        Panel(
            plot=_panel(curves, tests_of(trainings, network), measure, bounds),
            height_px=290,
            title=f"Network {network}",
        )
        for network, curves in drawn.items()
    )
    first = measure == "reward"
    return Figure(
        name="figure-7-learning-curves" if first else "figure-7b-training-success",
        label="Figure 7" if first else "Figure 7b",
        title=(
            "Learning curves with levels and every test of eq. 5"
            if first
            else "Success of the training episodes"
        ),
        caption=(*_caption(drawn, measure), *_about_tests(drawn, trainings, measure)),
        alternative=(
            f"For each of {counted(len(drawn), 'network')}, {TITLES[measure]} over learning steps: "
            "initiation, then curriculum and control from the same network, with the curriculum's "
            "levels shaded and each level test marked."
        ),
        legend=(
            *arm_lines(TRAININGS),
            LegendEntry(text="level extended", colour=INK, shape="ring"),
            LegendEntry(text="level passed", colour=INK, shape="triangle"),
            LegendEntry(text="left at the limit of extensions", colour=INK, shape="square"),
        ),
        panels=panels,
        panel_width_px=420,
        still=lambda: _still(drawn, trainings, measure, bounds),
        data=learning_data(drawn, trainings, measure),
    )


def _bounds(drawn: Mapping[int, list[Curve]], measure: Measure) -> tuple[float, float]:
    if measure == "success":
        return -0.04, 1.1
    # A few roll-outs with odd episodes must not press all others together.
    values = np.concatenate([curve.values for curves in drawn.values() for curve in curves])
    low, high = float(np.quantile(values, RARE)), float(values.max())
    margin = 0.05 * (high - low or abs(high) or 1.0)
    return low - margin, high + 3 * margin


def _begin(curves: list[Curve]) -> int:
    return max(curve.begin for curve in curves)


def _caption(drawn: Mapping[int, list[Curve]], measure: Measure) -> tuple[str, ...]:
    windows = sorted({curve.window for curves in drawn.values() for curve in curves})
    span = f"{windows[0]}" if len(windows) == 1 else f"{windows[0]} to {windows[-1]}"
    lines = (
        f"Thin lines: each roll-out; thick lines: running mean over {span} roll-outs within a "
        "level."
    )
    if windows[-1] == 1:
        lines = "One point per roll-out."
    shown = (
        "Rewards are as given by the environment, before any normalisation; the scale leaves out "
        f"the lowest {percent(RARE)} of roll-outs."
        if measure == "reward"
        else "Training episodes start at random poses on the variants of the level or, in "
        "initiation and control, of the whole range: the curves are no test."
    )
    return (
        lines,
        "Shaded: the levels of the curriculum. The control learns as long, on uniform variants.",
        shown,
    )


def _about_tests(
    drawn: Mapping[int, list[Curve]], trainings: Trainings, measure: Measure
) -> tuple[str, ...]:
    tests = [test for network in drawn for _, test in tests_of(trainings, network)]
    hint = "Hovering over a mark shows what eq. 5 measured and decided."
    if measure == "reward" and any(test.measure == "episode" for test in tests):
        return (
            "The curves are rewards per learning step; eq. 5 compares mean rewards of episodes.",
            hint,
        )
    return (hint,)


def _panel(
    curves: list[Curve],
    tests: list[tuple[int, LevelTest]],
    measure: Measure,
    bounds: tuple[float, float],
) -> go.Figure:
    figure = plot(x_title="learning steps since the network began", y_title=TITLES[measure])
    levels = levels_of(tests, _begin(curves))
    for level, start, stop in levels:
        figure.add_shape(
            type="rect",
            x0=start,
            x1=stop,
            y0=0,
            y1=1,
            yref="paper",
            fillcolor=translucent(BAND, 0.10 if level % 2 == 0 else 0.04),
            line={"width": 0},
            layer="below",
        )
        annotate(
            figure,
            _level_name(level, len(levels)),
            x=(start + stop) / 2,
            y=1.0,
            yref="paper",
            yanchor="top",
        )
    for curve in curves:
        style = ARM_STYLES[curve.kind]
        if curve.window > 1:
            figure.add_trace(
                go.Scatter(
                    x=compact(curve.steps.astype(np.float64)),
                    y=compact(curve.values),
                    mode="lines",
                    line={"color": translucent(style.colour, 0.3), "width": 1},
                    hoverinfo="skip",
                )
            )
        figure.add_trace(
            go.Scatter(
                x=compact(curve.steps.astype(np.float64)),
                y=compact(curve.smooth),
                mode="lines+markers" if curve.steps.size == 1 else "lines",
                line={"color": style.colour, "width": 2.2, "dash": style.dash},
                hovertext=[
                    hover(
                        f"{style.name}, {integer(int(step))} steps",
                        f"{number(value)} (running mean {number(mean)})",
                    )
                    for step, value, mean in zip(
                        curve.steps.tolist(),
                        curve.values.tolist(),
                        curve.smooth.tolist(),
                        strict=True,
                    )
                ],
                hoverinfo="text",
            )
        )
    _add_tests(figure, curves, tests)
    figure.update_yaxes(range=list(bounds))
    figure.update_xaxes(rangemode="tozero", tickformat="~s", nticks=6)
    return figure


def _level_name(level: int, levels: int) -> str:
    return f"level {level + 1}" if levels <= 3 else f"{level + 1}"


def _learning(curves: list[Curve]) -> Curve | None:
    return next((curve for curve in curves if curve.kind == CURRICULUM), None)


def _add_tests(figure: go.Figure, curves: list[Curve], tests: list[tuple[int, LevelTest]]) -> None:
    curve = _learning(curves)
    if curve is None or not tests:
        return
    figure.add_trace(
        go.Scatter(
            x=[step for step, _ in tests],
            y=[curve.at(step) for step, _ in tests],
            mode="markers",
            marker={
                "symbol": [DECISIONS[test.decision][1] for _, test in tests],
                "color": [DECISIONS[test.decision][3] for _, test in tests],
                "size": 10,
                "line": {"color": INK, "width": 1.6},
            },
            hovertext=[_test_label(test) for _, test in tests],
            hoverinfo="text",
            cliponaxis=False,
        )
    )


def _test_label(test: LevelTest) -> str:
    ratio = "undefined" if test.ratio is None else f"{test.ratio:.3f}".replace("-", MINUS)
    iteration = f"extension {test.iteration}" if test.iteration else "first iteration"
    return hover(
        f"Level {test.level + 1}, {iteration}: {test.decision}",
        f"rF = {number(test.first_window, 4)}, rL = {number(test.last_window, 4)}",
        f"ratio of eq. 5: {ratio}, threshold {test.threshold:g}",
        test.sentence,
    )


def _still(
    drawn: Mapping[int, list[Curve]],
    trainings: Trainings,
    measure: Measure,
    bounds: tuple[float, float],
) -> StillFigure:
    columns = 1 if len(drawn) == 1 else 2
    rows = -(-len(drawn) // columns)
    figure, axes = axes_grid(
        rows, columns, height_in=2.1 * rows + 0.45, used=len(drawn), share_y=True
    )
    for (network, curves), ax in zip(drawn.items(), axes, strict=True):
        _draw(ax, curves, tests_of(trainings, network))
        ax.set_title(f"Network {network}")
        ax.set_ylim(*bounds)
    for index, ax in enumerate(axes):
        if index % columns == 0:
            ax.set_ylabel(TITLES[measure])
        if index + columns >= len(axes):
            ax.set_xlabel("learning steps, thousands")
    for kind in TRAININGS:
        style = ARM_STYLES[kind]
        axes[0].plot([], [], color=style.colour, ls=style.line, label=style.name)
    for name, _, marker, fill in DECISIONS.values():
        axes[0].plot([], [], marker, mfc=fill, mec=INK, ms=5, label=name)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=6, columnspacing=1.1)
    return figure


def _draw(ax: Axes, curves: list[Curve], tests: list[tuple[int, LevelTest]]) -> None:
    levels = levels_of(tests, _begin(curves))
    for level, start, stop in levels:
        ax.axvspan(
            start / 1e3, stop / 1e3, color=BAND, alpha=0.10 if level % 2 == 0 else 0.04, lw=0
        )
        ax.annotate(
            _level_name(level, len(levels)),
            ((start + stop) / 2e3, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, -3),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=7,
        )
    for curve in curves:
        style, x = ARM_STYLES[curve.kind], curve.steps / 1e3
        if curve.window > 1:
            ax.plot(x, curve.values, color=style.colour, alpha=0.3, lw=0.5)
        marker = "o" if curve.steps.size == 1 else None
        ax.plot(x, curve.smooth, color=style.colour, ls=style.line, lw=1.5, marker=marker, ms=3)
    learning = _learning(curves)
    if learning is not None:
        for step, test in tests:
            _, _, marker, fill = DECISIONS[test.decision]
            ax.plot(
                step / 1e3, learning.at(step), marker, mfc=fill, mec=INK, ms=5, mew=0.9, zorder=4
            )
    ax.set_xlim(left=0)
    ax.grid(visible=True)
