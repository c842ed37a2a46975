"""Films of a run: one trial on the hardest variant before, with and without the curriculum."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from surmount.core.records import write_record
from surmount.envs.video import write_mp4, write_png
from surmount.experiment.config import config_from_record
from surmount.report.films import file_of_film, kept_films
from surmount.rstar.configured import obstacle_of
from surmount.rstar.film.film import FilmConfig, contact_sheet, frames
from surmount.rstar.film.logged_trials import logged_motion, run_log
from surmount.trials.table import read_trials
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import (
    FILM_FOLDER,
    FILMS,
    SCHEMA,
    TRIALS,
    TRIALS_FILE,
    per_network,
)

NETWORK, TRIAL = 0, 0
"""Shown is always the first trial of the first network, whatever happens in it."""
FILM = FilmConfig(width_px=480, height_px=360, speed=2.0)
SHEET = FilmConfig(width_px=320, height_px=240)


def draw_films(run: RunFolder, say: Callable[[str], None]) -> None:
    """Draw a film and a sheet of moments of every kind of trials that a run has.

    Written are ``films/<kind>.mp4``, ``films/<kind>.png`` and ``films.json``, which names them with
    their hashes. Films whose trials have not changed are kept.

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
    size_mm = obstacle_of(config_from_record(run.config)).hardest
    earlier = kept_films(run)
    drawn: list[dict[str, Any]] = []
    for kind, stage_kind in TRIALS.items():
        stage = per_network(stage_kind, NETWORK)
        if stage not in run.stages:
            continue
        key = run.stages[stage].key
        if key in earlier:
            drawn.append(earlier[key])
            continue
        table = run.stages[stage].path(TRIALS_FILE)
        trials = read_trials(table)
        log = run_log(run, stage, trials, str(table))
        motion = logged_motion(log, log.find(size_mm, TRIAL, NETWORK))
        film, sheet = (run.root / FILM_FOLDER / f"{kind}{suffix}" for suffix in (".mp4", ".png"))
        write_mp4(film, frames([motion], FILM), FILM.fps)
        write_png(sheet, contact_sheet([motion], SHEET))
        say(f"{film}: {motion.caption}: {motion.outcome}")
        alike = np.isclose(trials.variant[:, 0], size_mm)
        drawn.append(
            {
                "kind": kind,
                "stage": stage,
                "key": key,
                "size_mm": size_mm,
                "caption": motion.caption,
                "outcome": motion.outcome,
                "network": NETWORK,
                "successes": int(trials.success[alike].sum()),
                "trials": int(alike.sum()),
                "speed": FILM.speed,
                "film": file_of_film(film),
                "sheet": file_of_film(sheet),
                "duration_s": motion.duration_s,
            }
        )
    write_record(run.root / FILMS, {"schema": SCHEMA, "films": drawn})
