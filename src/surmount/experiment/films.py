"""Films of a run for its page, where this machine can draw them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from surmount.core.extras import told_error
from surmount.envs.own_family import OwnFamily
from surmount.envs.registry import find_family
from surmount.report.evidence import family_of
from surmount.workflow.run_folder import open_run
from surmount.workflow.store import output_errors


def films(root: Path, say: Callable[[str], None], *, own: bool = False) -> None:
    """Draw the films of a run, or say why there are none: the page does without them.

    Parameters
    ----------
    root
        Output folder of a run.
    say
        Told of every film.
    own
        Whether the module of one's own environment may be imported to draw; else what was drawn
        stays.
    """
    try:
        task = open_run(root).task
        family = find_family(task) if own and ":" in task else family_of(task)
        with output_errors(root):
            if isinstance(family, OwnFamily):
                from surmount.experiment.own_run_films import (  # noqa: PLC0415 - needs extras
                    draw_own_films,
                )

                draw_own_films(open_run(root), family, say)
            elif family is not None:
                family.draw_films(root, say)
    except Exception as error:
        told = told_error(error)
        if told is None:
            raise
        say(f"No films: {told.message} {told.remedy}")
