"""Vega for the page: one packed script that draws figures without a network."""

from __future__ import annotations

import gzip
from importlib import resources
from importlib.resources.abc import Traversable

import vl_convert

from surmount.report.figures.stills import VEGA_LITE

PACKED = "vega.js.gz"
"""Of the templates: Vega, Vega-Lite and Vega-Embed in one script, see :func:`bundle`."""
LICENCE = "vega-licence.txt"


def packed() -> bytes:
    """Return the script as the page carries it, packed by gzip."""
    return (_templates() / PACKED).read_bytes()


def bundle() -> bytes:
    """Make the packed script anew: ``make vega``, when the version of vl-convert changes.

    It takes some ten seconds, which is why it lies in the package.
    """
    snippet = "window.vegaEmbed = vegaEmbed;"
    script = vl_convert.javascript_bundle(snippet, vl_version=VEGA_LITE)
    licence = (_templates() / LICENCE).read_text(encoding="utf-8").strip()
    text = f"/*\n{versions()}\n\n{licence}\n*/\n(() => {{\n{script}\n}})();\n"
    return gzip.compress(text.encode(), compresslevel=9, mtime=0)


def versions() -> str:
    """Return which versions a script made now would hold."""
    return (
        f"Vega {vl_convert.get_vega_version()}, Vega-Lite {VEGA_LITE}, "
        f"Vega-Embed {vl_convert.get_vega_embed_version()}"
    )


def _templates() -> Traversable:
    return resources.files("surmount.report") / "templates"
