"""Figure 8: success of both arms in every group, with intervals and tests."""

from __future__ import annotations

from collections.abc import Mapping

import altair as alt
import numpy as np

from surmount.report.comparison import Comparison, GroupComparison, Success, VariantSuccess
from surmount.report.document.parts import Columns, Figure
from surmount.report.document.text import integer, number, p_value, percent, percent_interval, short
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
from surmount.report.figures.palette import ARM_STYLES, INK, PAPER
from surmount.report.outcomes import Outcomes
from surmount.stats.proportions import proportion_intervals
from surmount.tasks.curriculum import Curriculum
from surmount.workflow.run_layout import ARMS, TRAININGS

BAR_WIDTH = 0.26
OPACITY = 0.8
HEIGHT_PX = 280
LEAST_PX = 340


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
        chart=figure([_panel(comparison, bars, dots)], columns=1, least_px=LEAST_PX),
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


def _panel(comparison: Comparison, bars: Bars, dots: Dots) -> alt.LayerChart:
    look = [ARM_STYLES[kind] for kind in TRAININGS]
    names = [entry.group for entry in comparison.groups]
    x = x_of("x", None, domain=(-0.5, len(names) - 0.5), axis=None)
    y = shares("share of trials that succeed", top=1.2)
    base = alt.Chart(frame(_bar_rows(bars, names))).encode(
        opacity=seen(OPACITY), tooltip=["group:N", alt.Tooltip("series:N", title="after"),
                                        "success:N", "interval:N"],
    )  # fmt: skip
    places = list(range(len(names)))
    tests = [annotation(entry).replace(", ", "\n") for entry in comparison.groups]
    return layers(
        base.mark_rect().encode(
            x, y, x2="x2:Q", y2=alt.datum(0), **styles(look, "color")
        ),
        base.mark_rule(color=INK, strokeWidth=1.4).encode(
            alt.X("middle:Q"), alt.Y("lower:Q"), y2="upper:Q", opacity=seen()
        ),
        alt.Chart(frame(_dot_rows(dots, names)))
        .mark_point(size=40, fill=PAPER, stroke=INK, strokeWidth=1.3)
        .encode(
            alt.X("x:Q"),
            alt.Y("y:Q"),
            opacity=seen(),
            tooltip=["network:N", "group:N", alt.Tooltip("series:N", title="after"), "success:N"],
        ),
        words({"x": places, "y": [1.04] * len(places), "text": tests}, baseline="line-bottom",
              lineBreak="\n", dy=-12),
        tick_labels(places, names, HEIGHT_PX),
        height=HEIGHT_PX,
    )  # fmt: skip


def _bar_rows(bars: Bars, names: list[str]) -> dict[str, list[object]]:
    columns: dict[str, list[object]] = {
        name: []
        for name in ("x", "x2", "middle", "y", "lower", "upper", "series", "group", "success",
                     "interval")
    }  # fmt: skip
    for kind, entries in bars.items():
        for index, (success, lower, upper) in enumerate(entries):
            middle, half = index + _offset(kind), BAR_WIDTH * 0.47
            row = (
                *(middle - half, middle + half, middle, success.rate or 0.0, lower, upper),
                *(ARM_STYLES[kind].name, short(names[index])),
                (
                    f"{integer(success.successes)} of {integer(success.trials)} trials: "
                    f"{percent(success.rate, 1)}"
                ),
                percent_interval(lower, upper, 1),
            )
            for column, value in zip(columns.values(), row, strict=True):
                column.append(value)
    return columns


def _dot_rows(dots: Dots, names: list[str]) -> dict[str, list[object]]:
    columns: dict[str, list[object]] = {
        name: [] for name in ("x", "y", "series", "network", "group", "success")
    }
    for kind, entries in dots.items():
        for index, rates in enumerate(entries):
            for (network, rate), offset in zip(rates.items(), _spread(len(rates)), strict=True):
                row = (index + _offset(kind) + offset, rate, ARM_STYLES[kind].name,
                       f"network {network}", short(names[index]), percent(rate, 1))  # fmt: skip
                for column, value in zip(columns.values(), row, strict=True):
                    column.append(value)
    return columns


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
