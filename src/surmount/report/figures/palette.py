"""Colours that remain distinct without full colour vision (Okabe & Ito 2008), with their markers.

Arms and groups never share a colour, and whatever colour tells, a marker, a dash or a label tells
too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from surmount.report.document.parts import LegendEntry
from surmount.workflow.run_layout import CONTROL, CURRICULUM, INITIATION

INK = "#1c1c1c"
MUTED = "#5f5f5f"
GRID = "#e4e4e4"
PAPER = "#ffffff"

GROUP_COLOURS = ("#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#8C6D31", "#999999")
"""Of groups from easy to difficult: bluish green, orange, reddish purple, sky blue, then two
earth tones."""

SEQUENTIAL = ((0.0, "#f7fbff"), (0.35, "#9ecae1"), (0.7, "#3182bd"), (1.0, "#08306b"))
"""Light to dark for distances from 0 to 1; monotone in lightness, so it prints in grey."""


@dataclass(frozen=True, kw_only=True)
class ArmStyle:
    """How one stage of learning is drawn everywhere.

    Attributes
    ----------
    name
        As printed.
    colour, dash, marker
        Colour, Plotly's dash of lines and symbol of points.
    line, point
        The same for Matplotlib.
    """

    name: str
    colour: str
    dash: str
    marker: str
    line: str
    point: str


ARM_STYLES = {
    INITIATION: ArmStyle(
        name=INITIATION, colour="#7a7a7a", dash="dot", marker="circle", line=":", point="o"
    ),
    CURRICULUM: ArmStyle(
        name=CURRICULUM, colour="#0072B2", dash="solid", marker="square", line="-", point="s"
    ),
    CONTROL: ArmStyle(
        name=CONTROL, colour="#D55E00", dash="dash", marker="diamond", line="--", point="D"
    ),
}
"""What was learnt on what: initiation, then either the curriculum or uniform variants."""


def arm_lines(kinds: Sequence[str]) -> tuple[LegendEntry, ...]:
    """Return the legend of lines in the styles of what was learnt."""
    styles = [ARM_STYLES[kind] for kind in kinds]
    return tuple(
        LegendEntry(
            text=style.name,
            colour=style.colour,
            shape={"dot": "dot", "solid": "line"}.get(style.dash, "dash"),  # type: ignore[arg-type]
        )
        for style in styles
    )


def group_colour(group: int) -> str:
    """Return the colour of a group counted from the easiest."""
    return GROUP_COLOURS[group % len(GROUP_COLOURS)]


def translucent(colour: str, alpha: float) -> str:
    """Return a hexadecimal colour as ``rgba(…)`` with an opacity."""
    red, green, blue = (int(colour[start : start + 2], 16) for start in (1, 3, 5))
    return f"rgba({red},{green},{blue},{alpha:g})"
