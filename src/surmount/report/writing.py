"""Writing the page, the figures and their data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from surmount.analysis import Analysis
from surmount.core.records import write_atomically
from surmount.core.store import output_errors, refuse_links
from surmount.report.analysis_page import document_of_analysis
from surmount.report.contents import document_of
from surmount.report.document import Figure
from surmount.report.overview import overview_of
from surmount.report.page import page
from surmount.report.results import read_run
from surmount.report.stills import StillFiles, draw, write_still

PAGE = "report.html"
FIGURES = "figures"


def write_run_report(root: Path) -> Path:
    """Write the page and the figures of a run; see :func:`surmount.report.write_report`."""
    with output_errors(root):
        refuse_links(root)
    document = document_of(read_run(root))
    with output_errors(root):
        stills = _write_figures(document.figures(), root / FIGURES)
        write_atomically(root / PAGE, page(document, stills).encode())
    return root / PAGE


def write_overview_page(roots: Sequence[Path], out: Path) -> Path:
    """Write the page of several runs; see :func:`surmount.report.write_overview`."""
    document = overview_of([read_run(root) for root in roots])
    with output_errors(out):
        stills = _write_figures(document.figures(), out / FIGURES)
        write_atomically(out / PAGE, page(document, stills).encode())
    return out / PAGE


def write_analysis_page(record: Mapping[str, Any], root: Path) -> Path:
    """Write the page of an analysis; see :func:`surmount.report.write_analysis_report`."""
    document = document_of_analysis(Analysis.from_record(record))
    with output_errors(root):
        stills = _write_figures(document.figures(), root / FIGURES)
        write_atomically(root / PAGE, page(document, stills).encode())
    return root / PAGE


def _write_figures(figures: Sequence[Figure], folder: Path) -> dict[str, StillFiles]:
    stills = {figure.name: draw(figure.still) for figure in figures}
    for figure in figures:
        write_still(folder, figure.name, stills[figure.name], figure.data)
    return stills
