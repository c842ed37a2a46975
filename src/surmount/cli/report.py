"""``surmount report``: draw the page of a run again."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.part_progress import PartProgress
from surmount.core.errors import ConfigError
from surmount.core.printing import say

FOLLOW_S = 10.0
"""Between two looks at a run that is followed."""


def report(
    folder: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="DIR ...")],
    *,
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None,
    follow: bool = False,
) -> int:
    """Write report.html, report.md, figures and films of a run; works on unfinished runs.

    Args:
        folder: The --out folder of a run; of several, with --out, for one page over all of them.
        out: Folder for the page over several runs.
        follow: Draw the page of a run again whenever a stage is finished, until all are.
    """
    if out is not None:
        if follow:
            raise ConfigError(
                "A page over several runs is not followed.",
                remedy="Leave out --follow, or give one run.",
            )
        with PartProgress() as telling:
            telling(f"reading {len(folder)} runs")
            # After the first line: what draws takes seconds to import.
            from surmount.studies.paper.pages import write_overview

            page = write_overview(folder, out)
        say(f"Report: {page.resolve()}")
        return 0
    if len(folder) != 1:
        raise ConfigError(
            f"There are {len(folder)} runs.",
            remedy="Give one run, or --out for a page over several.",
        )
    return _follow(folder[0]) if follow else _write(folder[0])


def _write(root: Path) -> int:
    """Write the page, and say what it cannot show yet."""
    with PartProgress() as telling:
        telling(f"reading {root}")
        # After the first line: what draws takes seconds to import.
        from surmount.experiment.films import films
        from surmount.report.pages import write_report
        from surmount.workflow.run_folder import open_run

        run = open_run(root)
    if run.missing:
        done = len(run.protocol)
        say(
            f"{done} of {done + len(run.missing)} stages are finished; next comes "
            f"{run.missing[0]}. What learns now: tensorboard --logdir {root / 'logs'}"
        )
    films(root, say)
    with PartProgress() as telling:
        telling("drawing the page")
        page = write_report(root)
    say(f"Report: {page.resolve()}")
    return 0


def _follow(root: Path) -> int:
    """Write the page whenever there is more to show; Ctrl-C ends it."""
    from surmount.workflow.run_folder import open_run

    shown = -1
    while True:
        run = open_run(root)
        if len(run.protocol) > shown:
            shown = len(run.protocol)
            _write(root)
            if run.missing:
                say("Reload it in the browser after the next line; Ctrl-C ends this.")
        if not run.missing:
            return 0
        time.sleep(FOLLOW_S)
