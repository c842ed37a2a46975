"""Figure 9: path lengths of sprawl and FBEM over successful trials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go
from matplotlib.axes import Axes
from matplotlib.figure import Figure as StillFigure

from surmount.core.arrays import FloatArray
from surmount.report.document.parts import Columns, Figure, LegendEntry, Panel
from surmount.report.document.text import integer, name_and_unit, number, short
from surmount.report.figures.palette import ARM_STYLES, translucent
from surmount.report.figures.plots import annotate, compact, hover, plain, plot
from surmount.report.figures.stills import axes_grid
from surmount.report.outcomes import PATHS, Outcomes
from surmount.tasks.curriculum import Curriculum
from surmount.workflow.run_layout import ARMS

BOX_WIDTH = 0.3
WHISKER = 1.5
"""Whiskers reach to the outermost value within so many interquartile ranges of the box."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Box:
    """The five numbers of a box plot and what lies beyond (Tukey).

    Attributes
    ----------
    count
        Values in all.
    low, q1, median, q3, high
        End of the lower whisker, quartiles, end of the upper whisker.
    beyond
        Values outside the whiskers.
    """

    count: int
    low: float
    q1: float
    median: float
    q3: float
    high: float
    beyond: FloatArray


def box_of(values: FloatArray) -> Box:
    """Summarise at least one value."""
    q1, median, q3 = np.quantile(values, [0.25, 0.5, 0.75]).tolist()
    reach = WHISKER * (q3 - q1)
    inside = values[(values >= q1 - reach) & (values <= q3 + reach)]
    return Box(
        count=int(values.size),
        low=float(inside.min()),
        q1=q1,
        median=median,
        q3=q3,
        high=float(inside.max()),
        beyond=values[(values < q1 - reach) | (values > q3 + reach)],
    )


Boxes = Mapping[str, Mapping[str, list[Box | None]]]
"""By path and arm, one entry per group; ``None`` where no trial succeeded."""


def path_lengths(curriculum: Curriculum, tests: Mapping[str, Outcomes]) -> Figure | None:
    """Draw box plots per group and arm (paper fig. 9); ``None`` where no path was logged."""
    arms = [arm for arm in ARMS if arm in tests]
    paths = [path for path in PATHS if all(path in tests[arm].path_lengths for arm in arms)]
    if not arms or not paths:
        return None
    boxes: Boxes = {
        path: {arm: _boxes(tests[arm], curriculum, path) for arm in arms} for path in paths
    }
    names = [group.name for group in curriculum.groups]
    return Figure(
        name="figure-9-path-lengths",
        label="Figure 9",
        title="Path lengths of the joints over successful trials",
        caption=(
            (
                "Σ|Δ| of the angle over each successful test trial of all networks. Boxes: "
                f"quartiles; whiskers: to the outermost trial within {WHISKER:g} interquartile "
                "ranges; rings: trials beyond. A shorter path is a calmer motion."
            ),
        ),
        alternative="Box plots of path lengths, medians: "
        + "; ".join(
            f"{name_and_unit(path)[0]}, {name}, {arm} "
            + (f"{number(box.median)}°" if (box := boxes[path][arm][index]) else "none")
            for path in paths
            for index, name in enumerate(names)
            for arm in arms
        )
        + ".",
        legend=tuple(
            LegendEntry(text=ARM_STYLES[arm].name, colour=ARM_STYLES[arm].colour, shape="square")
            for arm in arms
        ),
        panels=tuple(
            Panel(
                plot=_panel(path, boxes[path], names),
                height_px=330,
                title=f"Path length of {name_and_unit(path)[0]}",
            )
            for path in paths
        ),
        panel_width_px=300,
        still=lambda: _still(boxes, names),
        data=_data(curriculum, tests, arms, paths),
    )


def _boxes(outcomes: Outcomes, curriculum: Curriculum, path: str) -> list[Box | None]:
    groups, lengths = curriculum.groups_of(outcomes.variant), outcomes.path_lengths[path]
    found: list[Box | None] = []
    for group in range(len(curriculum.groups)):
        values = lengths[outcomes.success & (groups == group)]
        found.append(box_of(values) if values.size else None)
    return found


def _offset(arm: str) -> float:
    return (ARMS.index(arm) - 0.5) * 1.15 * BOX_WIDTH


def _label(path: str) -> str:
    return f"Σ|Δ {name_and_unit(path)[0]}| (°)"


def _panel(path: str, boxes: Mapping[str, list[Box | None]], names: list[str]) -> go.Figure:
    figure = plot(x_title="", y_title=_label(path))
    for arm, found in boxes.items():
        style = ARM_STYLES[arm]
        known = [(index, box) for index, box in enumerate(found) if box is not None]
        x = [index + _offset(arm) for index, _ in known]
        figure.add_trace(
            go.Box(
                x=x,
                lowerfence=[box.low for _, box in known],
                q1=[box.q1 for _, box in known],
                median=[box.median for _, box in known],
                q3=[box.q3 for _, box in known],
                upperfence=[box.high for _, box in known],
                width=BOX_WIDTH,
                line={"color": style.colour, "width": 1.8},
                fillcolor=translucent(style.colour, 0.25),
                hoverinfo="skip",
            )
        )
        beyond = [
            (at, value) for at, (_, box) in zip(x, known, strict=True) for value in box.beyond
        ]
        figure.add_trace(
            go.Scatter(
                x=[at for at, _ in beyond],
                y=compact([value for _, value in beyond]),
                mode="markers",
                marker={"symbol": "circle-open", "size": 5, "color": style.colour},
                hoverinfo="skip",
            )
        )
        # Invisible marks on the medians carry the numbers.
        figure.add_trace(
            go.Scatter(
                x=x,
                y=[box.median for _, box in known],
                mode="markers",
                marker={"size": 16, "opacity": 0},
                hovertext=[
                    hover(
                        f"{names[index]}, {style.name}: {integer(box.count)} successful trials",
                        f"median {number(box.median)}°, quartiles {number(box.q1)}° and "
                        f"{number(box.q3)}°",
                    )
                    for index, box in known
                ],
                hoverinfo="text",
            )
        )
        for index, box in enumerate(found):
            if box is None:
                annotate(
                    figure,
                    "no success",
                    x=index + _offset(arm),
                    y=0,
                    yanchor="bottom",
                    textangle=-90,
                )
    figure.update_xaxes(
        tickvals=list(range(len(names))),
        ticktext=[plain(short(name)) for name in names],
        showgrid=False,
        range=[-0.5, len(names) - 0.5],
    )
    figure.update_yaxes(rangemode="tozero")
    return figure


def _still(boxes: Boxes, names: list[str]) -> StillFigure:
    figure, axes = axes_grid(1, len(boxes), height_in=2.8)
    for (path, arms), ax in zip(boxes.items(), axes, strict=True):
        for arm, found in arms.items():
            _draw(ax, arm, found)
        ax.set_xticks(range(len(names)), [short(name) for name in names])
        ax.set_xlim(-0.5, len(names) - 0.5)
        ax.set_ylim(bottom=0)
        ax.set_ylabel(_label(path))
        ax.grid(visible=True, axis="y")
    for arm in next(iter(boxes.values())):
        style = ARM_STYLES[arm]
        axes[0].bar(0, 0, color=style.colour, alpha=0.6, label=style.name)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=2)
    return figure


def _draw(ax: Axes, arm: str, found: list[Box | None]) -> None:
    style = ARM_STYLES[arm]
    for index, box in enumerate(found):
        at = index + _offset(arm)
        if box is None:
            ax.annotate(
                "no success",
                (at, 0.0),
                xytext=(0, 3),
                textcoords="offset points",
                rotation=90,
                ha="center",
                va="bottom",
                fontsize=6.5,
            )
            continue
        line = {"color": style.colour, "linewidth": 1.2}
        ax.bxp(
            [
                {
                    "whislo": box.low,
                    "q1": box.q1,
                    "med": box.median,
                    "q3": box.q3,
                    "whishi": box.high,
                    "fliers": box.beyond,
                }
            ],
            positions=[at],
            widths=BOX_WIDTH,
            patch_artist=True,
            manage_ticks=False,
            boxprops={"facecolor": (*_rgb(style.colour), 0.25), "edgecolor": style.colour},
            medianprops={**line, "linewidth": 1.8},
            whiskerprops=line,
            capprops=line,
            flierprops={"marker": "o", "markersize": 2.5, "mfc": "none", "mec": style.colour},
        )


def _rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[start : start + 2], 16) / 255 for start in (1, 3, 5))
    return red, green, blue


def _data(
    curriculum: Curriculum, tests: Mapping[str, Outcomes], arms: list[str], paths: list[str]
) -> Columns:
    """Return one row per successful trial."""
    variants = [f"variant.{name}" for name in curriculum.parameters]
    columns: dict[str, list[object]] = {
        name: [] for name in ("arm", "group", *variants, "network", "trial")
    }
    lengths: dict[str, list[object]] = {f"path_length.{path}": [] for path in paths}
    for arm in arms:
        outcomes = tests[arm]
        won = np.flatnonzero(outcomes.success)
        groups = curriculum.groups_of(outcomes.variant)[won].tolist()
        columns["arm"] += [arm] * won.size
        columns["group"] += [None if i < 0 else curriculum.groups[i].name for i in groups]
        for index, name in enumerate(variants):
            columns[name] += outcomes.variant[won, index].tolist()
        columns["network"] += outcomes.network[won].tolist()
        columns["trial"] += outcomes.repetition[won].tolist()
        for path in paths:
            lengths[f"path_length.{path}"] += outcomes.path_lengths[path][won].tolist()
    return columns | lengths
