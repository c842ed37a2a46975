"""Numbers between every two variants as a heat map, with the groups framed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import plotly.graph_objects as go
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure as StillFigure
from matplotlib.patches import Rectangle

from surmount.analysis.result import Analysis
from surmount.core.arrays import FloatArray
from surmount.report.document.text import axis_label
from surmount.report.figures.palette import SEQUENTIAL, group_colour
from surmount.report.figures.plots import compact, hover, plain, plot


def matrix_panel(
    analysis: Analysis, values: FloatArray, words: Callable[[float], str], *, likeness: bool = False
) -> go.Figure:
    """Return an interactive heat map of values from 0 to 1, shape ``(variant, variant)``.

    Parameters
    ----------
    analysis
        The analysis whose variants and groups these are.
    values
        What is drawn.
    words
        A value as the label that appears on hovering tells it.
    likeness
        Whether 1 means alike, and is drawn light; else 0 does.
    """
    labels = analysis.labels_of_variants
    title = variant_title(analysis)
    figure = plot(x_title=title, y_title=title)
    n = len(labels)
    names = [analysis.groups[group].name for group in analysis.labels]
    figure.add_trace(
        go.Heatmap(
            z=compact(values),
            x=np.arange(n),
            y=np.arange(n),
            zmin=0,
            zmax=1,
            colorscale=[list(stop) for stop in _stops(likeness=likeness)],
            hovertext=[
                [
                    hover(
                        f"{labels[row]} ({names[row]}) and {labels[column]} ({names[column]})",
                        words(float(values[row, column])),
                    )
                    for column in range(n)
                ]
                for row in range(n)
            ],
            hoverinfo="text",
            colorbar={
                "orientation": "h",
                "thickness": 9,
                "len": 0.6,
                "y": 1.0,
                "yanchor": "bottom",
                "tickvals": [0, 0.5, 1],
                "outlinewidth": 0,
            },
        )
    )
    for start, stop in runs(analysis):
        figure.add_shape(
            type="rect",
            x0=start - 0.5,
            x1=stop + 0.5,
            y0=start - 0.5,
            y1=stop + 0.5,
            line={"color": group_colour(int(analysis.labels[start])), "width": 3},
        )
    ticks = ticks_of(n)
    axis: dict[str, Any] = {
        "tickvals": ticks,
        "ticktext": [plain(labels[i]) for i in ticks],
        "showgrid": False,
        "constrain": "domain",
    }
    figure.update_xaxes(**axis, range=[-0.6, n - 0.4])
    figure.update_yaxes(**axis, range=[n - 0.4, -0.6], scaleanchor="x")
    figure.update_layout(margin={"t": 4})
    return figure


def draw_matrix(
    figure: StillFigure,
    ax: Axes,
    analysis: Analysis,
    values: FloatArray,
    title: str,
    *,
    likeness: bool = False,
) -> None:
    """Draw the same with Matplotlib, the meaning of the colours above it."""
    n = analysis.variants.shape[0]
    colours = LinearSegmentedColormap.from_list("matrix", list(_stops(likeness=likeness)))
    image = ax.imshow(values, vmin=0, vmax=1, cmap=colours, interpolation="nearest")
    for start, stop in runs(analysis):
        size, colour = stop - start + 1, group_colour(int(analysis.labels[start]))
        ax.add_patch(Rectangle((start - 0.5, start - 0.5), size, size, fill=False, ec=colour, lw=2))
    ticks = ticks_of(n)
    labels = [analysis.label(i) for i in ticks]
    ax.set_xticks(ticks, labels, rotation=0 if len(analysis.parameters) == 1 else 90)
    ax.set_yticks(ticks, labels)
    ax.set_xlabel(variant_title(analysis))
    ax.set_ylabel(variant_title(analysis))
    ax.spines[:].set_visible(False)
    figure.colorbar(image, ax=ax, shrink=0.6, location="top", label=title)


def variant_title(analysis: Analysis) -> str:
    """Return the title of an axis of variants."""
    if len(analysis.parameters) == 1:
        return axis_label(analysis.parameters[0])
    return f"variant: {', '.join(axis_label(name) for name in analysis.parameters)}"


def runs(analysis: Analysis) -> list[tuple[int, int]]:
    """Return first and last index of each run of neighbouring variants of one group."""
    edges = np.flatnonzero(np.diff(analysis.labels)) + 1
    starts = [0, *edges.tolist()]
    return list(zip(starts, [*(edges - 1).tolist(), analysis.labels.size - 1], strict=True))


def ticks_of(n: int) -> list[int]:
    """Return the variants that are labelled: ten at most."""
    step = -(-n // 10)
    return list(range(0, n, step))


def _stops(*, likeness: bool) -> list[tuple[float, str]]:
    if not likeness:
        return list(SEQUENTIAL)
    return [(1.0 - place, colour) for place, colour in reversed(SEQUENTIAL)]
