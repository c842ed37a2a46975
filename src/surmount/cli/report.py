"""``surmount report``: draw the page of a run again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from surmount.report import write_report


def report(folder: Annotated[Path, tyro.conf.Positional]) -> int:
    """Write report.html and the figures of a run from its artefacts; works on unfinished runs.

    Args:
        folder: The --out folder of a run.
    """
    print(f"Report: {write_report(folder).resolve()}")
    return 0
