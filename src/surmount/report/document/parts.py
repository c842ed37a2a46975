"""The page as plain records: sections of paragraphs, tables and figures, before any HTML.

Sections build these from a run; one template turns them into HTML and escapes every string on the
way, so no text from a file is ever taken for markup.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import plotly.graph_objects as go
from matplotlib.figure import Figure as StillFigure

Columns = Mapping[str, Sequence[object]]
"""A table of data by column, all of the same length."""


@dataclass(frozen=True, kw_only=True)
class LegendEntry:
    """One entry of a figure's legend, drawn beside the plots and not in them.

    Attributes
    ----------
    text
        What it stands for.
    colour
        Of the swatch.
    shape
        Of the swatch.
    """

    text: str
    colour: str
    shape: Literal[
        "line", "dash", "dot", "square", "circle", "ring", "triangle", "diamond", "cross"
    ]


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """One interactive plot of a figure.

    Attributes
    ----------
    plot
        The plot.
    height_px
        Its height on the screen; its width is what the page has.
    title
        Heading of the plot.
    """

    plot: go.Figure
    height_px: int
    title: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Figure:
    """A figure: interactive on the screen, still on paper, with the data it shows.

    Attributes
    ----------
    name
        Stem of its file names.
    label, title
        ``"Figure 5"`` and what it shows.
    caption
        Sentences on how to read it.
    alternative
        What it shows, for those who cannot see it.
    legend
        Shared by all panels.
    panels
        Interactive plots, laid out side by side where the page is wide enough.
    panel_width_px
        Least width of a panel before the layout takes fewer columns.
    still
        Draws the same with Matplotlib.
    data
        What is drawn, for the CSV file.
    """

    name: str
    label: str
    title: str
    caption: tuple[str, ...]
    alternative: str
    legend: tuple[LegendEntry, ...]
    panels: tuple[Panel, ...]
    panel_width_px: int
    still: Callable[[], StillFigure]
    data: Columns
    kind: Literal["figure"] = "figure"


@dataclass(frozen=True, kw_only=True)
class Column:
    """Heading of a table's column; numbers are set to the right."""

    heading: str
    numeric: bool = False


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table of text.

    Attributes
    ----------
    label, title
        ``"Table 1"``, or empty where it is not one of the paper's, and what it shows.
    columns, rows
        Headings, and as many cells in each row.
    notes
        Sentences below it.
    """

    label: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()
    kind: Literal["table"] = "table"


@dataclass(frozen=True, kw_only=True, eq=False)
class Film:
    """A film on the screen, and moments of it on paper.

    Attributes
    ----------
    title
        What it shows, in a few words.
    caption
        Sentences below it.
    mp4, png
        Content of the film and of the picture that stands for it in print.
    """

    title: str
    caption: tuple[str, ...]
    mp4: bytes
    png: bytes


@dataclass(frozen=True, kw_only=True, eq=False)
class Films:
    """Films side by side."""

    films: tuple[Film, ...]
    kind: Literal["films"] = "films"


@dataclass(frozen=True, kw_only=True)
class Paragraph:
    """A paragraph of text."""

    text: str
    kind: Literal["paragraph"] = "paragraph"


@dataclass(frozen=True, kw_only=True)
class Notice:
    """Sentences that a reader must not overlook.

    Attributes
    ----------
    title
        In a few words.
    sentences
        One or several.
    """

    title: str
    sentences: tuple[str, ...]
    kind: Literal["notice"] = "notice"


@dataclass(frozen=True, kw_only=True, eq=False)
class Fold:
    """Blocks that open on a click, and are always open in print.

    Attributes
    ----------
    summary
        What is inside.
    blocks
        The content.
    """

    summary: str
    blocks: tuple[Block, ...]
    kind: Literal["fold"] = "fold"


Block: TypeAlias = "Figure | Films | Table | Paragraph | Notice | Fold"


@dataclass(frozen=True, kw_only=True, eq=False)
class Section:
    """A section of the page with its anchor."""

    anchor: str
    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Document:
    """The whole page.

    Attributes
    ----------
    title, subtitle
        Heading of the page.
    notices
        Above everything else.
    summary
        The result in a few plain sentences.
    facts
        Short facts beside the summary: name and value.
    sections
        In reading order.
    """

    title: str
    subtitle: str
    notices: tuple[Notice, ...]
    summary: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...]

    def figures(self) -> tuple[Figure, ...]:
        """Return all figures in reading order."""
        blocks = [block for section in self.sections for block in section.blocks]
        return tuple(_figures(blocks))


def _figures(blocks: Sequence[Block]) -> list[Figure]:
    found: list[Figure] = []
    for block in blocks:
        if isinstance(block, Figure):
            found.append(block)
        elif isinstance(block, Fold):
            found += _figures(block.blocks)
    return found
