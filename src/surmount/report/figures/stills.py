"""Still figures in one style, and the files they are written to: SVG, PNG and CSV."""

from __future__ import annotations

import csv
import io
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as StillFigure

from surmount.core.names import text_cell
from surmount.core.records import write_atomically
from surmount.report.document.parts import Columns
from surmount.report.figures.palette import GRID, INK

STYLE = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.labelcolor": INK,
    "axes.edgecolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "text.color": INK,
    "text.parse_math": False,  # a dollar sign in a name is a dollar sign
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "lines.linewidth": 1.3,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.fonttype": "path",  # looks the same wherever it is opened
    "svg.hashsalt": "surmount",  # and has the same bytes whenever it is written
}
PNG_DPI = 200
CLOUD_DPI = 130
"""Of clouds of points, the only part of an SVG that is not drawn by lines."""
WIDTH_IN = 7.2
"""Width of a still: the text width of a printed page."""


@dataclass(frozen=True, kw_only=True)
class StillFiles:
    """A still figure as the content of its files."""

    svg: bytes
    png: bytes


def axes_grid(
    rows: int,
    columns: int,
    *,
    height_in: float,
    width_in: float = WIDTH_IN,
    used: int | None = None,
    share_y: bool = False,
    share_x: bool = False,
    width_ratios: Sequence[float] | None = None,
) -> tuple[StillFigure, list[Axes]]:
    """Return a figure with so many axes in reading order; those beyond ``used`` are hidden."""
    figure = StillFigure(figsize=(width_in, height_in), layout="constrained")
    grid = figure.subplots(
        rows, columns, squeeze=False, sharey=share_y, sharex=share_x, width_ratios=width_ratios
    )
    axes: list[Axes] = list(np.asarray(grid).ravel())
    for spare in axes[used or len(axes) :]:
        spare.set_visible(False)
    return figure, axes[: used or len(axes)]


def draw(still: Callable[[], StillFigure]) -> StillFiles:
    """Draw a still in the style of the page."""
    with mpl.rc_context(STYLE), warnings.catch_warnings():  # type: ignore[arg-type]
        # A name may hold characters that no installed font has: a box stands for them.
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
        figure = still()
        svg, png = io.BytesIO(), io.BytesIO()
        metadata = {"Date": None, "Creator": "Surmount"}
        figure.savefig(svg, format="svg", metadata=metadata, dpi=CLOUD_DPI)
        figure.set_layout_engine("none")  # as it was laid out for the SVG
        figure.savefig(png, format="png", metadata={"Software": "Surmount"}, dpi=PNG_DPI)
    return StillFiles(svg=svg.getvalue(), png=png.getvalue())


def write_still(folder: Path, name: str, files: StillFiles, data: Columns) -> None:
    """Write a still and its data: ``<name>.svg``, ``.png`` and ``.csv``."""
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
