"""Films of a run for its page, where this machine can draw them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from surmount.core.extras import told_error
from surmount.report.evidence import family_of
from surmount.workflow.run_folder import open_run
from surmount.workflow.store import output_errors


def films(root: Path, say: Callable[[str], None]) -> None:
    """Draw the films of a run, or say why there are none: the page does without them."""
    try:
        family = family_of(open_run(root).task)
        if family is not None:
            with output_errors(root):
                family.draw_films(root, say)
    except Exception as error:
        told = told_error(error)
        if told is None:
            raise
        say(f"No films: {told.message} {told.remedy}")
