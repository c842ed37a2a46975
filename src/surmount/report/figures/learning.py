"""Figure 7: learning curves of every network, with levels and every decision of eq. 5."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import altair as alt
import numpy as np

from surmount.report.document.parts import Figure
from surmount.report.document.text import MINUS, counted, integer, number, percent
from surmount.report.figures.charts import (
    figure,
    frame,
    layers,
    seen,
    shares,
    styles,
    words,
    x_of,
    y_of,
)
from surmount.report.figures.curves import (
    Curve,
    Measure,
    Trainings,
    curves_of,
    learning_data,
    levels_of,
    tests_of,
)
from surmount.report.figures.palette import ARM_STYLES, INK, PAPER, Series
from surmount.teachers.teacher import Decision, LevelTest
from surmount.workflow.run_layout import CURRICULUM, TRAININGS

TITLES = {
    "reward": "mean reward per step",
    "success": "success of episodes",
}
DECISIONS: dict[Decision, Series] = {
    "extend": Series(name="level extended", colour=PAPER, shape="circle"),
    "advance": Series(name="level passed", colour=INK, shape="triangle-up"),
    "advance at the limit": Series(
        name="left at the limit of extensions", colour=INK, shape="square"
    ),
}
"""How each decision is marked."""
RARE = 0.02
"""Share of roll-outs that may lie below the panels."""
BAND = "#0072b2"
MOST_POINTS = 400
"""Of each curve that are drawn; all of them are in the data."""
HEIGHT_PX = 230
LEAST_PX = 400


def learning_curves(trainings: Trainings, measure: Measure) -> Figure | None:
    """Draw the measure over all learning of each network; ``None`` where nothing was learnt."""
    networks = sorted({network for found in trainings.values() for network in found})
    drawn = {network: curves_of(trainings, network, measure) for network in networks}
    drawn = {network: curves for network, curves in drawn.items() if curves}
    if not drawn:
        return None
    bounds = _bounds(drawn, measure)
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
        chart=figure(
            [
                _panel(network, curves, tests_of(trainings, network), measure, bounds)
                for network, curves in drawn.items()
            ],
            columns=2,
            least_px=LEAST_PX,
            zoom=True,
        ),
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
    network: int,
    curves: list[Curve],
    tests: list[tuple[int, LevelTest]],
    measure: Measure,
    bounds: tuple[float, float],
) -> alt.LayerChart:
    title = "learning steps since the network began"
    last = max(int(curve.steps[-1]) for curve in curves)
    x = x_of(
        "x", title, domain=(0, 1.02 * last), axis=alt.Axis(format="~s", tickCount=6, grid=False)
    )

    def y(field: str) -> alt.Y:
        if measure == "success":
            return shares(TITLES[measure], field, bottom=bounds[0], top=bounds[1])
        return y_of(field, TITLES[measure], domain=bounds)

    return layers(
        *_lines(curves, x, y),
        *_levels(levels_of(tests, _begin(curves))),
        *_tests(curves, tests, y("y")),
        height=HEIGHT_PX,
        title=f"Network {network}",
    )


def _lines(curves: list[Curve], x: alt.X, y: Callable[[str], alt.Y]) -> list[alt.Chart]:
    """Return each roll-out thin, and the running mean of them thick."""
    columns: dict[str, list[object]] = {
        name: [] for name in ("x", "y", "mean", "series", "steps", "rollout", "running mean")
    }
    for curve in curves:
        every = np.linspace(0, curve.steps.size - 1, min(MOST_POINTS, curve.steps.size))
        for index in np.unique(np.round(every).astype(np.int64)):
            value, mean = float(curve.values[index]), float(curve.smooth[index])
            own = (int(curve.steps[index]), value, mean, curve.kind,
                   integer(int(curve.steps[index])), number(value), number(mean))  # fmt: skip
            for column, entry in zip(columns.values(), own, strict=True):
                column.append(entry)
    look = [ARM_STYLES[kind] for kind in TRAININGS]
    base = alt.Chart(frame(columns)).encode(x)
    lines = [
        base.mark_line(strokeWidth=0.8, clip=True).encode(
            y("y"), opacity=seen(0.5), **styles(look, "color")
        ),
        base.mark_line(strokeWidth=2.2, clip=True).encode(
            y("mean"), opacity=seen(), **styles(look, "color", "strokeDash")
        ),
        # Nearly invisible, and easy to hit: they carry the numbers.
        base.mark_point(filled=True, size=40, clip=True).encode(
            y("mean"),
            opacity=alt.value(1.0 if max(c.steps.size for c in curves) == 1 else 0.0),
            tooltip=[
                alt.Tooltip("series:N", title="stage"),
                "steps:N",
                alt.Tooltip("rollout:N", title="roll-out"),
                "running mean:N",
            ],
            **styles(look, "color"),
        ),
    ]
    return lines if any(curve.window > 1 for curve in curves) else lines[1:]


def _levels(levels: list[tuple[int, int, int]]) -> list[alt.Chart]:
    """Return the levels as bands with their numbers."""
    if not levels:
        return []
    numbers, starts, stops = zip(*levels, strict=True)
    names = [f"level {level + 1}" if len(levels) <= 3 else f"{level + 1}" for level in numbers]
    shades = [0.14 if level % 2 == 0 else 0.06 for level in numbers]
    rows = frame({"x": starts, "x2": stops, "shade": shades, "level": names})
    band = (
        alt.Chart(rows)
        .mark_rect(color=BAND, clip=True)
        .encode(
            alt.X("x:Q"),
            x2="x2:Q",
            opacity=alt.Opacity("shade:Q", scale=None, legend=None),
            tooltip="level:N",
        )
    )
    middles = [(start + stop) / 2 for start, stop in zip(starts, stops, strict=True)]
    names = {"x": middles, "text": names}
    return [band, words(names, y=alt.value(4), baseline="top", size=10, clip=True)]


def _tests(curves: list[Curve], tests: list[tuple[int, LevelTest]], y: alt.Y) -> list[alt.Chart]:
    """Return a mark at each test of a level, which tells what eq. 5 measured and decided."""
    curve = next((curve for curve in curves if curve.kind == CURRICULUM), None)
    if curve is None or not tests:
        return []
    told = [_told(test) for _, test in tests]
    rows = {
        "x": [step for step, _ in tests],
        "y": [curve.at(step) for step, _ in tests],
        "decision": [DECISIONS[test.decision].name for _, test in tests],
        **{name: [own[name] for own in told] for name in told[0]},
    }
    look = tuple(DECISIONS.values())
    return [
        alt.Chart(frame(rows))
        .mark_point(size=70, stroke=INK, strokeWidth=1.6, opacity=1)
        .encode(
            alt.X("x:Q"),
            y,
            tooltip=[f"{name}:N" for name in ("decision", *told[0])],
            **styles(look, "shape", "fill", field="decision"),
        )
    ]


def _told(test: LevelTest) -> dict[str, str]:
    iteration = f"extension {test.iteration}" if test.iteration else "first iteration"
    ratio = "undefined" if test.ratio is None else f"{test.ratio:.3f}".replace("-", MINUS)
    return {
        "level": f"{test.level + 1}, {iteration}",
        "first and last window": f"{number(test.first_window, 4)}, {number(test.last_window, 4)}",
        "ratio of eq 5": f"{ratio}, threshold {test.threshold:g}",
        "in words": test.sentence,
    }
