"""``surmount report``: draw the page of a run again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from surmount.core.errors import ConfigError
from surmount.core.printing import say


def report(
    folder: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="DIR ...")],
    *,
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None,
) -> int:
    """Write report.html, report.md, figures and films of a run; works on unfinished runs.

    Args:
        folder: The --out folder of a run; of several, with --out, for one page over all of them.
        out: Folder for the page over several runs.
    """
    from surmount.experiment.films import films
    from surmount.report.pages import write_report
    from surmount.studies.paper.pages import write_overview

    if out is not None:
        say(f"Report: {write_overview(folder, out).resolve()}")
        return 0
    if len(folder) != 1:
        raise ConfigError(
            f"There are {len(folder)} runs.",
            remedy="Give one run, or --out for a page over several.",
        )
    films(folder[0], print)
    say(f"Report: {write_report(folder[0]).resolve()}")
    return 0
