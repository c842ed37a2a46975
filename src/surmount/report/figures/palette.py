"""Colours that remain distinct without full colour vision, with their dashes and shapes.

All come after Okabe & Ito (2008), darkened until they stand out from the paper with a contrast of
at least 3 : 1, and each has a twin for dark pages. Arms and groups never share a colour, and
whatever colour tells, a dash, a shape or a label tells too.
"""

from __future__ import annotations

from dataclasses import dataclass

from surmount.workflow.run_layout import CONTROL, CURRICULUM, INITIATION

INK = "#1c1c1c"
MUTED = "#5f5f5f"
GRID = "#e4e4e4"
PAPER = "#ffffff"
RECORDED = "#444444"
ABOVE = "#555555"
"""Of links of a dendrogram above all groups."""

DARK = {
    INK: "#e8e6e3",
    MUTED: "#a3a7ad",
    GRID: "#31353b",
    PAPER: "#15181c",
    RECORDED: "#c4c4c4",
    ABOVE: "#b4b4b4",
    "#009e73": "#2bb58b",
    "#b87a00": "#e69f00",
    "#c0629a": "#d98cbb",
    "#2d8cc4": "#6cc0f0",
    "#8c6d31": "#bfa064",
    "#757575": "#a6a6a6",
    "#7a7a7a": "#a0a0a0",
    "#0072b2": "#4da9e0",
    "#d55e00": "#f08438",
}
"""What stands for each colour where the reader prefers dark pages."""

GROUP_COLOURS = ("#009e73", "#b87a00", "#c0629a", "#2d8cc4", "#8c6d31", "#757575")
"""Of groups from easy to difficult: bluish green, ochre, reddish purple, blue, two earth tones."""
GROUP_DASHES = ((1, 0), (8, 3), (3, 2), (10, 3, 2, 3), (1, 2), (6, 2, 2, 2))
GROUP_SHAPES = ("circle", "square", "triangle-up", "diamond", "cross", "triangle-down")

SEQUENTIAL = ("#f7fbff", "#9ecae1", "#3182bd", "#08306b")
"""Light to dark; monotone in lightness, so it prints in grey."""


@dataclass(frozen=True, kw_only=True)
class Series:
    """How one thing is drawn wherever it is drawn.

    Attributes
    ----------
    name
        As printed in the legend.
    colour, dash, shape
        Colour, dash of lines (drawn and left out, in turn) and shape of points.
    """

    name: str
    colour: str
    dash: tuple[int, ...] = (1, 0)
    shape: str = "circle"


ARM_STYLES = {
    INITIATION: Series(name=INITIATION, colour="#7a7a7a", dash=(2, 2), shape="circle"),
    CURRICULUM: Series(name=CURRICULUM, colour="#0072b2", dash=(1, 0), shape="square"),
    CONTROL: Series(name=CONTROL, colour="#d55e00", dash=(7, 3), shape="diamond"),
}
"""What was learnt on what: initiation, then either the curriculum or uniform variants."""


def group_series(index: int, name: str) -> Series:
    """Return how a group counted from the easiest is drawn."""
    place = index % len(GROUP_COLOURS)
    return Series(
        name=name,
        colour=GROUP_COLOURS[place],
        dash=GROUP_DASHES[place],
        shape=GROUP_SHAPES[place],
    )
