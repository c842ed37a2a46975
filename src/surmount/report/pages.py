"""Figures, tables and one page from the artefacts of a run, and from nothing else.

The public functions import what they need when they are called, so that a missing extra is told
in a sentence and not by a traceback.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from surmount.core.extras import missing_extra


def write_report(root: Path | str) -> Path:
    """Write ``report.html``, ``report.md`` and ``figures/`` of a run from its artefacts.

    The page is one file that works offline, on a phone and in print. A run that was not finished
    gives a page that says what is missing. The same artefacts give the same bytes.

    Parameters
    ----------
    root
        Output folder of a run: with ``run.json`` and, unless it was killed, ``index.json``.

    Returns
    -------
    Path
        The page; ``figures/`` beside it has each figure as SVG and PNG, with its data as CSV.

    Raises
    ------
    OutputError
        If there is no run in the folder, or it cannot be written.
    IntegrityError
        If an artefact does not have the content that its hash promises.
    InputError
        If an artefact does not have the form that this version reads.
    MissingExtraError
        If the extra ``report`` is not installed.
    """
    with extras_told():
        from surmount.report.writing import write_run_report  # noqa: PLC0415 - an extra

        return write_run_report(Path(root))


def write_analysis_report(analysis_record: Mapping[str, Any], root: Path | str) -> Path:
    """Write ``report.html``, ``report.md`` and ``figures/`` of an analysis of any trials.

    Parameters
    ----------
    analysis_record
        The JSON form of an analysis, as ``analysis.json`` holds it.
    root
        Folder for the page and the folder of figures.

    Returns
    -------
    Path
        The page; ``figures/`` beside it has each figure as SVG and PNG, with its data as CSV.

    Raises
    ------
    InputError
        If the record is not an analysis of this version.
    OutputError
        If the folder cannot be written.
    MissingExtraError
        If the extra ``report`` is not installed.
    """
    with extras_told():
        from surmount.report.writing import write_analysis_page  # noqa: PLC0415 - an extra

        return write_analysis_page(analysis_record, Path(root))


@contextmanager
def extras_told() -> Generator[None]:
    """Tell in a sentence which extra is missing."""
    try:
        yield
    except ModuleNotFoundError as error:
        known = missing_extra(error)
        if known is None:
            raise
        raise known from error
