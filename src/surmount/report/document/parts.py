"""The page as plain records: sections of paragraphs, tables and figures, before any HTML.

Sections build these from a run; one template turns them into HTML and escapes every string on the
way, so no text from a file is ever taken for markup.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import altair as alt

Chart: TypeAlias = "alt.Chart | alt.LayerChart | alt.ConcatChart"
Columns = Mapping[str, Sequence[object]]
"""A table of data by column, all of the same length."""

CODE = re.compile(r"`(\w(?:[\w.= -]*\w)?)`")
"""The one markup in texts: a name in backticks, of characters that mean nothing elsewhere."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Figure:
    """A figure: interactive on the screen, a picture before that and on paper, with its data.

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
    chart
        The one specification that page, Markdown, notebook and files are drawn from.
    data
        What is drawn, for the CSV file.
    """

    name: str
    label: str
    title: str
    caption: tuple[str, ...]
    alternative: str
    chart: Chart
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
    """Blocks that open on a click.

    Attributes
    ----------
    summary
        What is inside.
    blocks
        The content.
    printed
        Whether they are opened for printing.
    """

    summary: str
    blocks: tuple[Block, ...]
    printed: bool = True
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
