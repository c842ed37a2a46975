"""Figures as pictures, and the files they are written to: SVG, PNG and CSV."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import vl_convert

from surmount.core.names import text_cell
from surmount.core.records import write_atomically
from surmount.report.document.parts import Chart, Columns
from surmount.report.figures.palette import DARK

VEGA_LITE = "6.4"
"""Version of the language that Altair writes, by which pictures and pages are drawn."""
PNG_SCALE = 2.0
_NUMBER = re.compile(r"-?\d+\.\d{3,}")
_PLACE = re.compile(r"-?\d+\.\d{2,}")
_OUTLINE = re.compile(r'(?<= d=")[^"]*(?=")')
_SYMBOL = re.compile(
    r'<path transform="translate\(([-\d.]+),([-\d.]+)\)" (d="M[^"]*A[^"]*"|d="M-[^"]*Z")([^<>]*)/>'
)
_IDLE = re.compile(
    r'<path[^<>]* opacity="0"[^<>]*/>'  # carries labels that appear on hovering
    r'|<path class="foreground"[^<>]* d=""[^<>]*/>'
    r'|(?<=[" ]) ?(?:role|aria-roledescription|aria-hidden|pointer-events)="[^"<>]*"(?=[^<>]*>)'
)
"""What a picture does not need."""
_RGB = re.compile(r'(?<==")rgb\((\d+), (\d+), (\d+)\)(?=")')
_CLIP = re.compile(r'(?<=id=")clip\d+|(?<=url\(#)clip\d+')


@dataclass(frozen=True, kw_only=True)
class StillFiles:
    """A figure as the content of its files.

    Attributes
    ----------
    spec
        In Vega-Lite, as JSON on one line.
    svg, png
        As pictures; the first follows whether the reader prefers dark pages.
    """

    spec: str
    svg: bytes
    png: bytes


def draw(chart: Chart) -> StillFiles:
    """Draw a chart as pictures."""
    spec = specification(chart)
    svg = vl_convert.vegalite_to_svg(spec, vl_version=VEGA_LITE)
    return StillFiles(
        spec=spec,
        svg=_tidy(svg).encode(),
        png=vl_convert.svg_to_png(svg, scale=PNG_SCALE),
    )


def specification(chart: Chart) -> str:
    """Return a chart in Vega-Lite, the same text whenever it is asked for."""
    record: dict[str, Any] = chart.to_dict()
    return json.dumps(record, separators=(",", ":"), allow_nan=False)


def _tidy(svg: str) -> str:
    """Return a picture without idle digits, with the same names each time, for light and dark."""
    names: dict[str, str] = {}

    def renamed(found: re.Match[str]) -> str:
        return names.setdefault(found[0], f"clip{len(names)}")

    text = _CLIP.sub(renamed, _RGB.sub(_hexadecimal, svg))
    text = _symbols_once(_outside_text(_IDLE.sub("", text)))
    rules = "".join(
        f'[fill="{light}"]{{fill:{dark}}}[stroke="{light}"]{{stroke:{dark}}}'
        for light, dark in DARK.items()
    )
    style = f"<style>@media screen and (prefers-color-scheme:dark){{{rules}}}</style>"
    head, mark, rest = text.partition(">")
    return f"{head}{mark}{style}{rest}"


def _hexadecimal(found: re.Match[str]) -> str:
    return "#" + "".join(f"{int(part):02x}" for part in found.groups())


def _outside_text(svg: str) -> str:
    """Shorten the numbers in tags, and leave alone what is written between them."""
    parts = re.split(r"(<[^>]*>)", svg)
    return "".join(_short_numbers(part) if part.startswith("<") else part for part in parts)


def _short_numbers(tag: str) -> str:
    """Write a tag's outline to a tenth of a pixel, which no eye tells, other numbers finer."""
    outlined = _OUTLINE.sub(lambda found: _PLACE.sub(_tenths, found[0]), tag)
    return _NUMBER.sub(_hundredths, outlined)


def _tenths(found: re.Match[str]) -> str:
    return f"{float(found[0]):.1f}".rstrip("0").rstrip(".")


def _hundredths(found: re.Match[str]) -> str:
    return f"{float(found[0]):.2f}".rstrip("0").rstrip(".")


def _symbols_once(svg: str) -> str:
    """Return a picture in which symbols that are alike are defined once and placed often."""
    defined: dict[tuple[str, str], str] = {}

    def placed(found: re.Match[str]) -> str:
        name = defined.setdefault((found[3], found[4]), f"s{len(defined)}")
        return f'<use href="#{name}" x="{found[1]}" y="{found[2]}"/>'

    text = _SYMBOL.sub(placed, svg)
    symbols = "".join(
        f'<path id="{name}" {shape}{look}/>' for (shape, look), name in defined.items()
    )
    head, mark, rest = text.partition(">")
    return f"{head}{mark}<defs>{symbols}</defs>{rest}"


def write_still(folder: Path, name: str, files: StillFiles, data: Columns) -> None:
    """Write a figure and its data: ``<name>.svg``, ``.png`` and ``.csv``."""
    write_atomically(folder / f"{name}.svg", files.svg)
    write_atomically(folder / f"{name}.png", files.png)
    write_atomically(folder / f"{name}.csv", csv_text(data).encode())


def csv_text(columns: Columns) -> str:
    """Return data as CSV; an undefined value is an empty cell, and no text is a formula."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(_cell, columns))
    writer.writerows(zip(*(map(_cell, column) for column in columns.values()), strict=True))
    return text.getvalue()


def _cell(value: object) -> object:
    if value is None:
        return ""
    if isinstance(value, np.generic):
        return _cell(value.item())
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return text_cell(value)
    return repr(value) if isinstance(value, float) else value
