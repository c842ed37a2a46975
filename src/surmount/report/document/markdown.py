"""The document in Markdown: what a repository shows of a run, with links to its figures."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from html import escape

from surmount.report.document.parts import CODE, Block, Document, Figure, Notice, Table

_MARKUP = re.compile(r"(^[#+=-]|[\\`*_\[\]<>&|~$])")


def markdown(document: Document, *, page: str, figures: str) -> str:
    """Render a document.

    Parameters
    ----------
    document
        The document; every string in it is escaped.
    page
        Name of the page beside it, which shows what Markdown cannot.
    figures
        Name of the folder beside it with the still figures and their data.
    """
    parts = [
        f"# {_text(document.title)}",
        f"*{_text(document.subtitle)}.* Films and interactive figures: `{page}`.",
        *map(_notice, document.notices),
        _list(document.summary),
        _grid(("", ""), (False, False), document.facts),
    ]
    for section in document.sections:
        parts.append(f"## {_text(section.title)}")
        parts += _blocks(section.blocks, figures)
    return "\n\n".join(part for part in parts if part) + "\n"


def _blocks(blocks: Iterable[Block], figures: str) -> Iterator[str]:
    for block in blocks:
        match block.kind:
            case "paragraph":
                yield _text(block.text)
            case "table":
                yield from _table(block)
            case "figure":
                yield from _figure(block, figures)
            case "films":
                yield _list(
                    " ".join((f"Film: {film.title}.", *film.caption)) for film in block.films
                )
            case "notice":
                yield _notice(block)
            case "fold":
                yield f"<details><summary>{escape(block.summary)}</summary>"
                yield from _blocks(block.blocks, figures)
                yield "</details>"


def _table(table: Table) -> Iterator[str]:
    yield f"*{_titled(table.label, table.title)}*"
    columns = table.columns
    yield _grid([c.heading for c in columns], [c.numeric for c in columns], table.rows)
    yield _text(" ".join(table.notes))


def _figure(figure: Figure, folder: str) -> Iterator[str]:
    yield f"*{_titled(figure.label, figure.title)}*"
    yield f"![{_text(figure.alternative)}]({folder}/{figure.name}.png)"
    yield f"{_text(' '.join(figure.caption))} [Data]({folder}/{figure.name}.csv)"


def _notice(notice: Notice) -> str:
    return f"> **{_text(notice.title)}.** {_text(' '.join(notice.sentences))}"


def _titled(label: str, title: str) -> str:
    return _text(f"{label}. {title}" if label else title)


def _list(items: Iterable[str]) -> str:
    return "\n".join(f"- {_text(item)}" for item in items)


def _grid(headings: Iterable[str], numeric: Iterable[bool], rows: Iterable[tuple[str, ...]]) -> str:
    rules = ("---:" if number else "---" for number in numeric)
    lines = [map(_text, headings), rules, *(map(_text, row) for row in rows)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _text(text: str) -> str:
    """Return text on one line in which nothing but names in backticks is taken for markup."""
    parts = CODE.split(" ".join(text.split()))
    parts[::2] = (_MARKUP.sub(r"\\\1", part) for part in parts[::2])
    parts[1::2] = (f"`{name}`" for name in parts[1::2])
    return "".join(parts)
