"""The document as one HTML page that needs nothing else: no network, no other file."""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Mapping
from importlib import resources

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from surmount.report.document.parts import CODE, Document
from surmount.report.document.vega import packed
from surmount.report.figures.palette import DARK
from surmount.report.figures.stills import StillFiles, csv_text

TEMPLATES = "templates"
MOST_CSV = 100_000
"""Characters of a figure's data that the page carries; more lie beside it alone."""


def page(document: Document, stills: Mapping[str, StillFiles]) -> str:
    """Render a document.

    Parameters
    ----------
    document
        The document; every string in it is escaped by the template.
    stills
        Pictures by the name of their figure: shown until a figure comes into view and is drawn, in
        print, and where scripts do not run.
    """
    environment = Environment(
        loader=PackageLoader("surmount.report", TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["code"] = _code
    template = environment.get_template("page.html.j2")
    return template.render(
        document=document,
        data_uri=_data_uri,
        pictures={name: _picture(still.svg.decode()) for name, still in stills.items()},
        style=Markup(_own("page.css")),  # noqa: S704 - a file of this package
        script=Markup(_own("page.js")),  # noqa: S704 - a file of this package
        dark=Markup(json.dumps(DARK)),  # noqa: S704 - names of colours
        vega=base64.b64encode(packed()).decode(),
        charts=_packed_charts(document, stills),
    )


def _packed_charts(document: Document, stills: Mapping[str, StillFiles]) -> str:
    """Return specification and data of every figure, packed, so that no text in them is markup."""
    data = {figure.name: csv_text(figure.data) for figure in document.figures()}
    charts = {
        name: {"spec": stills[name].spec, "csv": csv if len(csv) <= MOST_CSV else None}
        for name, csv in data.items()
    }
    content = gzip.compress(json.dumps(charts).encode(), compresslevel=9, mtime=0)
    return base64.b64encode(content).decode()


def _code(text: str) -> Markup:
    """Return text with names in backticks as code."""
    return Markup(CODE.sub(r"<code>\1</code>", str(escape(text))))  # noqa: S704 - escaped


def _picture(svg: str) -> Markup:
    """Return a picture as an address for an attribute in single quotes: a quarter less than base64.

    What ends an attribute, an address or a line is written by its code; ``&`` is escaped as
    anywhere in HTML, so that the picture's own escapes stay what they are.
    """
    for character in "%#'\n\r\t":
        svg = svg.replace(character, f"%{ord(character):02X}")
    address = "data:image/svg+xml;charset=utf-8," + svg.replace("&", "&amp;")
    return Markup(address)  # noqa: S704 - escaped above


def _data_uri(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _own(name: str) -> str:
    return (resources.files("surmount.report") / TEMPLATES / name).read_text(encoding="utf-8")
