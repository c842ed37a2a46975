"""Figure 8: success of both arms in every group, with intervals and tests."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import plotly.graph_objects as go
from matplotlib.figure import Figure as StillFigure

from surmount.report.comparison import Comparison, GroupComparison, Success, VariantSuccess
from surmount.report.document.parts import Columns, Figure, LegendEntry, Panel
from surmount.report.document.text import integer, number, p_value, percent, percent_interval, short
from surmount.report.figures.palette import ARM_STYLES, INK, PAPER, translucent
from surmount.report.figures.plots import annotate, hover, plain, plot
from surmount.report.figures.stills import axes_grid
from surmount.report.outcomes import Outcomes
from surmount.stats.proportions import proportion_intervals
from surmount.tasks.curriculum import Curriculum
from surmount.workflow.run_layout import ARMS, TRAININGS

BAR_WIDTH = 0.26
OPACITY = 0.75


def success_by_group(
    comparison: Comparison, curriculum: Curriculum, tests: Mapping[str, Outcomes]
) -> Figure:
    """Draw success bars with Wilson's intervals, and each network's own rate (paper fig. 8)."""
    bars = _bars(comparison, curriculum)
    dots = _network_rates(tests, curriculum)
    return Figure(
        name="figure-8-success",
        label="Figure 8a",
        title="Success per group after the initiation, with curriculum and without",
        caption=(
            (
                "Bars: share of the test trials of all networks that succeeded, with 95 % Wilson "
                "intervals over trials. Small rings: each network's own rate."
            ),
            (
                "χ² and p: two-sample test for equality of proportions with continuity correction, "
                "curriculum against control (III-E). It takes trials as independent, which trials "
                "of one network are not: see the evidence over networks."
            ),
        ),
        alternative="Bars of success per group: "
        + "; ".join(
            f"{entry.group}: "
            + ", ".join(f"{ARM_STYLES[kind].name} {percent(rate)}" for kind, rate in rates)
            for entry, rates in (
                (
                    entry,
                    [(kind, bars[kind][index][0].rate) for kind in TRAININGS],
                )
                for index, entry in enumerate(comparison.groups)
            )
        )
        + ".",
        legend=(
            *(
                LegendEntry(
                    text=ARM_STYLES[kind].name, colour=ARM_STYLES[kind].colour, shape="square"
                )
                for kind in TRAININGS
            ),
            LegendEntry(text="one network", colour=INK, shape="ring"),
        ),
        panels=(Panel(plot=_panel(comparison, bars, dots), height_px=360),),
        panel_width_px=340,
        still=lambda: _still(comparison, bars, dots),
        data=_data(comparison, bars, dots),
    )


Bars = Mapping[str, list[tuple[Success, float, float]]]
Dots = Mapping[str, list[dict[int, float]]]


def _bars(comparison: Comparison, curriculum: Curriculum) -> Bars:
    """Return success with its interval by what was learnt, one entry per group."""
    bars: dict[str, list[tuple[Success, float, float]]] = {}
    for kind in TRAININGS:
        if kind in ARMS:
            found = [entry.arms[kind] for entry in comparison.groups]
        else:
            found = _pooled(comparison.by_variant[kind], curriculum)
        limits = proportion_intervals(
            [success.successes for success in found], [success.trials for success in found]
        )
        bars[kind] = list(zip(found, limits.lower, limits.upper, strict=True))
    return bars


def _pooled(rows: tuple[VariantSuccess, ...], curriculum: Curriculum) -> list[Success]:
    totals = np.zeros((len(curriculum.groups), 2), dtype=np.int64)
    for row in rows:
        group = curriculum.group_of(np.asarray(row.variant))
        if group is not None:
            totals[group] += [row.successes, row.trials]
    return [Success(successes=won, trials=tried) for won, tried in totals.tolist()]


def _network_rates(tests: Mapping[str, Outcomes], curriculum: Curriculum) -> Dots:
    """Return each network's success rate by what was learnt, one entry per group."""
    dots: dict[str, list[dict[int, float]]] = {}
    for kind, outcomes in tests.items():
        groups = curriculum.groups_of(outcomes.variant)
        dots[kind] = [
            {
                int(network): float(
                    outcomes.success[(groups == group) & (outcomes.network == network)].mean()
                )
                for network in np.unique(outcomes.network[groups == group])
            }
            for group in range(len(curriculum.groups))
        ]
    return dots


def annotation(entry: GroupComparison) -> str:
    """Return the test of one group as it stands above its bars."""
    test = entry.proportion_test
    if test.statistic is None:
        return "no test possible"
    return f"χ² = {number(test.statistic)}, {p_value(test.p_value)}"


def _offset(kind: str) -> float:
    return (TRAININGS.index(kind) - (len(TRAININGS) - 1) / 2) * BAR_WIDTH


def _spread(count: int) -> list[float]:
    """Return where the rings of so many networks stand on a bar, relative to its middle."""
    return [] if count == 0 else (np.linspace(-0.3, 0.3, count + 2)[1:-1] * BAR_WIDTH).tolist()


def _panel(comparison: Comparison, bars: Bars, dots: Dots) -> go.Figure:
    figure = plot(x_title="", y_title="share of trials that succeed")
    for kind in TRAININGS:
        style = ARM_STYLES[kind]
        entries = bars[kind]
        rates = [success.rate or 0.0 for success, _, _ in entries]
        x = [index + _offset(kind) for index in range(len(entries))]
        figure.add_trace(
            go.Bar(
                x=x,
                y=rates,
                width=BAR_WIDTH * 0.94,
                marker={"color": translucent(style.colour, OPACITY), "line": {"width": 0}},
                error_y={
                    "array": [
                        upper - rate for rate, (_, _, upper) in zip(rates, entries, strict=True)
                    ],
                    "arrayminus": [
                        rate - lower for rate, (_, lower, _) in zip(rates, entries, strict=True)
                    ],
                    "color": INK,
                    "thickness": 1.3,
                    "width": 5,
                },
                hovertext=[
                    hover(
                        f"{entry.group}, {style.name}",
                        f"{integer(success.successes)} of {integer(success.trials)} trials: "
                        f"{percent(success.rate, 1)}",
                        f"95 % interval {percent_interval(lower, upper, 1)}",
                    )
                    for entry, (success, lower, upper) in zip(
                        comparison.groups, entries, strict=True
                    )
                ],
                hoverinfo="text",
            )
        )
        _add_dots(figure, comparison, kind, dots.get(kind, []))
    for index, entry in enumerate(comparison.groups):
        annotate(figure, annotation(entry).replace(", ", "\n"), x=index, y=1.04, yanchor="bottom")
    figure.update_xaxes(
        tickvals=list(range(len(comparison.groups))),
        ticktext=[plain(short(entry.group)) for entry in comparison.groups],
        showgrid=False,
        range=[-0.5, len(comparison.groups) - 0.5],
    )
    figure.update_yaxes(range=[0, 1.2], tickvals=[0, 0.25, 0.5, 0.75, 1], tickformat=".0%")
    return figure


def _add_dots(
    figure: go.Figure, comparison: Comparison, kind: str, dots: list[dict[int, float]]
) -> None:
    x: list[float] = []
    y: list[float] = []
    text: list[str] = []
    for index, rates in enumerate(dots):
        for (network, rate), offset in zip(rates.items(), _spread(len(rates)), strict=True):
            x.append(index + _offset(kind) + offset)
            y.append(rate)
            text.append(
                hover(
                    f"{comparison.groups[index].group}, {ARM_STYLES[kind].name}, network {network}",
                    percent(rate, 1),
                )
            )
    figure.add_trace(
        go.Scatter(
            x=x,
            y=y,
            mode="markers",
            marker={"size": 7, "color": PAPER, "line": {"color": INK, "width": 1.2}},
            hovertext=text,
            hoverinfo="text",
            cliponaxis=False,
        )
    )


def _still(comparison: Comparison, bars: Bars, dots: Dots) -> StillFigure:
    figure, (ax,) = axes_grid(1, 1, height_in=3.0)
    for kind in TRAININGS:
        style = ARM_STYLES[kind]
        for index, (success, lower, upper) in enumerate(bars[kind]):
            x, rate = index + _offset(kind), success.rate or 0.0
            ax.bar(
                x,
                rate,
                BAR_WIDTH * 0.94,
                color=style.colour,
                alpha=OPACITY,
                label=style.name if index == 0 else None,
            )
            ax.errorbar(x, rate, [[rate - lower], [upper - rate]], color=INK, capsize=2.5, lw=0.9)
        for index, rates in enumerate(dots.get(kind, [])):
            for rate, offset in zip(rates.values(), _spread(len(rates)), strict=True):
                x = index + _offset(kind) + offset
                ax.plot(x, rate, "o", ms=3.5, mfc=PAPER, mec=INK, mew=0.7, clip_on=False, zorder=4)
    for index, entry in enumerate(comparison.groups):
        ax.text(index, 1.05, annotation(entry), ha="center", va="bottom", fontsize=7)
    names = [short(entry.group) for entry in comparison.groups]
    ax.set_xticks(range(len(names)), names)
    ax.set_yticks([0, 0.25, 0.5, 0.75, 1.0], ["0 %", "25 %", "50 %", "75 %", "100 %"])
    ax.set_ylim(0, 1.17)
    ax.set_ylabel("share of trials that succeed")
    handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=3)
    return figure


def _data(comparison: Comparison, bars: Bars, dots: Dots) -> Columns:
    columns: dict[str, list[object]] = {
        name: []
        for name in ("group", "stage", "network", "successes", "trials", "rate", "lower", "upper",
                     "chi_square", "p_value")
    }  # fmt: skip
    for index, entry in enumerate(comparison.groups):
        for kind in TRAININGS:
            success, lower, upper = bars[kind][index]
            test = entry.proportion_test if kind in ARMS else None
            row = (
                *(entry.group, kind, None),
                *(success.successes, success.trials, success.rate, lower, upper),
                *((test.statistic, test.p_value) if test else (None, None)),
            )
            for column, value in zip(columns.values(), row, strict=True):
                column.append(value)
            for network, rate in dots[kind][index].items() if kind in dots else ():
                own = (entry.group, kind, network, None, None, rate, None, None, None, None)
                for column, value in zip(columns.values(), own, strict=True):
                    column.append(value)
    return columns
