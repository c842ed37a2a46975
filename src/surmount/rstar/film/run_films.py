"""Films of a run: trials on the hardest variant, and where its arms differ most."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.records import write_record
from surmount.envs.video import write_mp4, write_png
from surmount.experiment.config import config_from_record
from surmount.report.film_choice import TITLE, arms_apart
from surmount.report.films import file_of_film, hardest_title, kept_films
from surmount.rstar.configured import obstacle_of
from surmount.rstar.film.film import FilmConfig, contact_sheet, frames
from surmount.rstar.film.logged_trials import logged_motion, run_log
from surmount.trials.table import read_trials
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import (
    ARMS,
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
SMALL_FILM = FilmConfig(width_px=320, height_px=240, speed=2.0)
SMALL_SHEET = FilmConfig(width_px=240, height_px=180)
"""Of the variant on which the arms differ most."""


@dataclass(frozen=True, kw_only=True)
class _Shown:
    """A variant to film: its title, how it was chosen, of which kinds of trials, and how."""

    size_mm: float
    title: str
    choice: str
    kinds: tuple[str, ...]
    suffix: str
    film: FilmConfig
    sheet: FilmConfig


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
    earlier = kept_films(run)
    drawn: list[dict[str, Any]] = []
    for shown in _shown(run):
        for kind in shown.kinds:
            stage = per_network(TRIALS[kind], NETWORK)
            if stage not in run.stages:
                continue
            kept = earlier.get((run.stages[stage].key, shown.title))
            film = _draw(run, kind, stage, shown, say) if kept is None else kept
            drawn.append({**film, "variant": shown.title, "choice": shown.choice})
    write_record(run.root / FILMS, {"schema": SCHEMA, "films": drawn})


def _shown(run: RunFolder) -> Iterator[_Shown]:
    config = config_from_record(run.config)
    obstacle = obstacle_of(config)
    hardest = obstacle.hardest
    apart = arms_apart(run, config.networks, lambda variants: obstacle.harder * variants[:, 0])
    is_hardest = apart is not None and apart.is_on(np.array([hardest]))
    yield _Shown(
        size_mm=hardest,
        title=hardest_title(hardest),
        choice="On it the arms differ most, too." if is_hardest else "",
        kinds=tuple(TRIALS),
        suffix="",
        film=FILM,
        sheet=SHEET,
    )
    if apart is not None and not is_hardest:
        size_mm = float(apart.variant[0])
        yield _Shown(
            size_mm=size_mm,
            title=f"{TITLE}, {size_mm:g} mm",
            choice=apart.rule,
            kinds=ARMS,
            suffix="-apart",
            film=SMALL_FILM,
            sheet=SMALL_SHEET,
        )


def _draw(
    run: RunFolder, kind: str, stage: str, shown: _Shown, say: Callable[[str], None]
) -> dict[str, Any]:
    """Draw one film and its sheet, and return its record."""
    table = run.stages[stage].path(TRIALS_FILE)
    trials = read_trials(table)
    log = run_log(run, stage, trials, str(table))
    motion = logged_motion(log, log.find(shown.size_mm, TRIAL, NETWORK))
    film, sheet = (
        run.root / FILM_FOLDER / f"{kind}{shown.suffix}{ending}" for ending in (".mp4", ".png")
    )
    write_mp4(film, frames([motion], shown.film), shown.film.fps)
    write_png(sheet, contact_sheet([motion], shown.sheet))
    say(f"{film}: {motion.caption}: {motion.outcome}")
    alike = np.isclose(trials.variant[:, 0], shown.size_mm)
    return {
        "kind": kind,
        "stage": stage,
        "key": run.stages[stage].key,
        "size_mm": shown.size_mm,
        "caption": motion.caption,
        "outcome": motion.outcome,
        "network": NETWORK,
        "successes": int(trials.success[alike].sum()),
        "trials": int(alike.sum()),
        "speed": shown.film.speed,
        "film": file_of_film(film),
        "sheet": file_of_film(sheet),
        "duration_s": motion.duration_s,
    }
