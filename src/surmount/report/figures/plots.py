"""Interactive plots in one style: what every panel of the page has in common."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from surmount.core.arrays import FloatArray
from surmount.report.figures.palette import GRID, INK, MUTED, PAPER

FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
LABEL_WIDTH = 60
"""Characters after which a label that appears on hovering is broken."""


def plot(*, x_title: str, y_title: str) -> go.Figure:
    """Return an empty plot in the style of the page; titles are taken as plain text."""
    axis = {
        "showline": True,
        "linecolor": INK,
        "linewidth": 1,
        "ticks": "outside",
        "ticklen": 4,
        "tickcolor": INK,
        "gridcolor": GRID,
        "zeroline": False,
        "automargin": True,
    }
    title = {"standoff": 8, "font": {"size": 13, "color": INK}}
    return go.Figure(
        layout={
            "template": {},
            "font": {"family": FONT, "size": 13, "color": INK},
            "paper_bgcolor": PAPER,
            "plot_bgcolor": PAPER,
            "margin": {"l": 8, "r": 12, "t": 10, "b": 8},
            "showlegend": False,
            "hovermode": "closest",
            "hoverlabel": {
                "bgcolor": PAPER,
                "bordercolor": MUTED,
                "align": "left",
                "font": {"family": FONT, "size": 12, "color": INK},
            },
            "xaxis": {**axis, "title": {"text": plain(x_title), **title}},
            "yaxis": {**axis, "title": {"text": plain(y_title), **title}},
        }
    )


def plain(text: str) -> str:
    """Return text so that Plotly shows it as it is, and takes no part of it for markup."""
    return html.escape(text, quote=False)


def hover(*lines: str) -> str:
    """Return the label that appears on hovering: plain lines, broken where they are long."""
    broken: list[str] = []
    for line in lines:
        rest = line
        while len(rest) > LABEL_WIDTH:
            at = rest.rfind(" ", 0, LABEL_WIDTH)
            if at <= 0:
                break
            broken.append(rest[:at])
            rest = rest[at + 1 :]
        broken.append(rest)
    return "<br>".join(plain(line) for line in broken)


def compact(values: FloatArray | Sequence[float]) -> np.ndarray:
    """Return values in single precision: half the size, and finer than any screen."""
    return np.asarray(values, dtype=np.float32)


def annotate(
    figure: go.Figure, text: str, *, x: float | str, y: float, size: int = 11, **options: object
) -> None:
    """Write plain text into a plot; several lines are separated by newlines."""
    figure.add_annotation(
        text="<br>".join(plain(line) for line in text.split("\n")),
        x=x,
        y=y,
        showarrow=False,
        font={"size": size, "color": INK},
        **options,
    )
