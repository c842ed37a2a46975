"""The page over several runs, claim by claim."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from surmount.core.records import write_record
from surmount.report.pages import extras_told


def write_overview(roots: Sequence[Path | str], out: Path | str) -> Path:
    """Write a page over several runs, one per obstacle: ``report.html``, and beside it the rest.

    The rest is ``report.md``, ``report.json`` with every claim and statistic, and ``figures/``.

    Parameters
    ----------
    roots
        Output folders of runs, finished or not.
    out
        Folder for the page and the folder of figures.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    SurmountError
        As :func:`write_report` for every run; an ``InputError`` if two are on the same obstacle.
    """
    with extras_told():
        from surmount.report.results import read_run  # noqa: PLC0415 - an extra
        from surmount.report.writing import write_document  # noqa: PLC0415
        from surmount.studies.paper.overview import (  # noqa: PLC0415
            overview_of,
            overview_record,
            together,
        )

        runs = [read_run(Path(root)) for root in roots]
        over_all = together(runs)
        page = write_document(overview_of(runs, over_all), Path(out))
        write_record(page.with_suffix(".json"), overview_record(runs, over_all))
        return page
