"""Films of a run: trials on the hardest variant, and where its arms differ most."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from surmount.envs.video import write_mp4, write_png
from surmount.experiment.config import config_from_record
from surmount.report.film_choice import arms_apart, shown_variants
from surmount.report.films import NETWORK, Wanted, draw_wanted, hardest_title
from surmount.rstar.configured import obstacle_of
from surmount.rstar.film.film import FilmConfig, contact_sheet, frames
from surmount.rstar.film.logged_trials import logged_motion, run_log
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import TRIALS_FILE

TRIAL = 0
"""Shown is always the first trial of the first network, whatever happens in it."""
FILM = FilmConfig(width_px=480, height_px=360, speed=2.0)
LARGE = (FILM, FilmConfig(width_px=320, height_px=240))
"""Film and sheet of the hardest variant."""
SMALL = (
    FilmConfig(width_px=320, height_px=240, speed=2.0),
    FilmConfig(width_px=240, height_px=180),
)
"""Of the variant on which the arms differ most."""


def draw_films(run: RunFolder, say: Callable[[str], None]) -> None:
    """Draw films and sheets of moments of the trials that a run has.

    Of every kind of trials the hardest variant is shown; of the tests of both arms also the one on
    which they differ most (:mod:`surmount.report.film_choice`), unless that is the hardest. Written
    are ``films/<kind>.mp4``, ``films/<kind>.png``, those of the second variant with ``-apart``, and
    ``films.json``, which names them with their hashes. Films whose trials have not changed are
    kept.

    Parameters
    ----------
    run
        The run.
    say
        Told of every film.

    Raises
    ------
    SurmountError
        If nothing can be drawn on this machine.
    """
    config = config_from_record(run.config)
    obstacle = obstacle_of(config)
    apart = arms_apart(run, config.networks, lambda variants: obstacle.harder * variants[:, 0])
    shown = shown_variants(
        np.array([obstacle.hardest]),
        hardest_title(obstacle.hardest),
        apart,
        lambda variant: f"{variant[0]:g} mm",
    )

    def draw(wanted: Wanted) -> dict[str, Any]:
        size_mm = float(wanted.shown.variant[0])
        table = str(run.stages[wanted.stage].path(TRIALS_FILE))
        log = run_log(run, wanted.stage, wanted.trials, table)
        motion = logged_motion(log, log.find(size_mm, TRIAL, NETWORK))
        film, sheet = SMALL if wanted.shown.is_second else LARGE
        write_mp4(wanted.film, frames([motion], film), film.fps)
        write_png(wanted.sheet, contact_sheet([motion], sheet))
        say(f"{wanted.film}: {motion.caption}: {motion.outcome}")
        return {
            "size_mm": size_mm,
            "caption": motion.caption,
            "outcome": motion.outcome,
            "speed": film.speed,
            "duration_s": motion.duration_s,
        }

    draw_wanted(run, shown, draw)
