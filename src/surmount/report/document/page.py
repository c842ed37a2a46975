"""The document as one HTML page that needs nothing else: no network, no other file."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from importlib import resources

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from surmount.report.document.parts import Document, Figure
from surmount.report.figures.stills import StillFiles, csv_text

TEMPLATES = "templates"


def page(document: Document, stills: Mapping[str, StillFiles]) -> str:
    """Render a document.

    Parameters
    ----------
    document
        The document; every string in it is escaped by the template.
    stills
        Still files by the name of their figure, shown in print and where scripts do not run.
    """
    environment = Environment(
        loader=PackageLoader("surmount.report", TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["plot_json"] = _script_safe
    template = environment.get_template("page.html.j2")
    return template.render(
        document=document,
        data_uri=_data_uri,
        figures={figure.name: _embedded(figure, stills) for figure in document.figures()},
        style=Markup(_own("page.css")),  # noqa: S704 - a file of this package
        script=Markup(_own("page.js")),  # noqa: S704 - a file of this package
        plotly=Markup(get_plotlyjs()),  # noqa: S704 - a file of the Plotly package
    )


def _embedded(figure: Figure, stills: Mapping[str, StillFiles]) -> dict[str, str]:
    return {
        "csv": _data_uri(csv_text(figure.data).encode(), "text/csv;charset=utf-8"),
        "svg": _data_uri(stills[figure.name].svg, "image/svg+xml"),
    }


def _data_uri(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _own(name: str) -> str:
    return (resources.files("surmount.report") / TEMPLATES / name).read_text(encoding="utf-8")


def _script_safe(json: str) -> Markup:
    """Return JSON that cannot end the script element it stands in, whatever text it holds."""
    safe = json.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
    return Markup(safe)  # noqa: S704 - nothing in it can be taken for markup any more
