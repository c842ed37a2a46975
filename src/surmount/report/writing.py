"""Writing the page, the figures and their data."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from surmount.analysis.result import Analysis
from surmount.core.records import write_atomically
from surmount.report.analysis_page import document_of_analysis
from surmount.report.contents import document_of
from surmount.report.document.markdown import markdown
from surmount.report.document.page import page
from surmount.report.document.parts import Document
from surmount.report.figures.stills import draw, write_still
from surmount.report.results import read_run
from surmount.workflow.store import output_errors, refuse_links

FIGURES = "figures"


def write_run_report(root: Path) -> Path:
    """Write the page and the figures of a run; see :func:`surmount.report.write_report`."""
    with output_errors(root):
        refuse_links(root)
    return write_document(document_of(read_run(root)), root)


def write_analysis_page(record: Mapping[str, Any], root: Path) -> Path:
    """Write the page of an analysis; see :func:`surmount.report.write_analysis_report`."""
    return write_document(document_of_analysis(Analysis.from_record(record)), root)


def write_document(document: Document, folder: Path, name: str = "report") -> Path:
    """Write a document as a page and in Markdown, and its figures with their data.

    Returns
    -------
    Path
        The page.
    """
    path = folder / f"{name}.html"
    figures = document.figures()
    with output_errors(folder):
        stills = {figure.name: draw(figure.chart) for figure in figures}
        for figure in figures:
            write_still(folder / FIGURES, figure.name, stills[figure.name], figure.data)
        text = markdown(document, page=path.name, figures=FIGURES)
        write_atomically(path.with_suffix(".md"), text.encode())
        write_atomically(path, page(document, stills).encode())
    return path
