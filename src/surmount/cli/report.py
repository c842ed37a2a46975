"""``surmount report``: draw the page of a run again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.films import films
from surmount.report import write_report


def report(folder: Annotated[Path, tyro.conf.Positional]) -> int:
    """Write report.html, figures and films of a run from its artefacts; works on unfinished runs.

    Args:
        folder: The --out folder of a run.
    """
    films(folder, print)
    print(f"Report: {write_report(folder).resolve()}")
    return 0
