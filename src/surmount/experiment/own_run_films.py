"""Films of a run on somebody's own environment, for its page: drawn by the environment itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.records import write_record
from surmount.envs.own_family import OwnFamily
from surmount.envs.video import Frame, write_mp4, write_png
from surmount.experiment.config import ExperimentConfig, config_from_record
from surmount.experiment.own_films import FilmedEpisode, can_draw, film_network
from surmount.report.film_choice import TITLE, arms_apart
from surmount.report.films import file_of_film, kept_films
from surmount.trials.table import read_trials
from surmount.trials.trials import Trials
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import (
    ARMS,
    FILM_FOLDER,
    FILMS,
    INITIATION,
    NETWORK_FILE,
    SCHEMA,
    TRIALS,
    TRIALS_FILE,
    per_network,
)

NETWORK = 0
MOST_FRAMES = 240
MOST_PX = 320
"""Frames of a film, and their width and height, at the most: some 100 kB a film."""
LONGEST_S = 10.0
MOST_FPS = 50
"""Films are as fast as the environment, or faster where they would be longer than this."""
MOMENTS = (2, 3)
"""Rows and columns of a sheet of moments."""
RULE = (
    "always one episode of the first network, drawn from its policy with the seed of the run, "
    "whatever happens in it; it is none of the trials"
)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Shown:
    """A variant to film, ``(parameter,)``: its title, how it was chosen, and of which kinds."""

    variant: FloatArray
    told: str
    title: str
    choice: str
    kinds: tuple[str, ...]
    suffix: str


def draw_own_films(run: RunFolder, family: OwnFamily, say: Callable[[str], None]) -> None:
    """Draw films and sheets of moments of the first network of every kind that was tried.

    Shown is the variant on which the initial networks succeeded least often, of equals the last of
    the grid; of both arms also the one on which they differ most in the tests
    (:mod:`surmount.report.film_choice`), unless that is the same. Written is what
    :func:`surmount.report.films.read_films` reads; films whose trials have not changed are kept.
    Nothing is drawn where the environment says that it draws nothing.

    Parameters
    ----------
    run
        The run.
    family
        Its environment's.
    say
        Told of every film.

    Raises
    ------
    InputError
        If the environment cannot be drawn on this machine.
    """
    config = config_from_record(run.config)
    initial = _initial_trials(run, config.networks)
    if not initial or not can_draw(family, config.env):
        return
    earlier = kept_films(run)
    drawn: list[dict[str, Any]] = []
    for shown in _shown(run, family, config, initial):
        for kind in shown.kinds:
            stage = per_network(TRIALS[kind], NETWORK)
            if stage not in run.stages:
                continue
            kept = earlier.get((run.stages[stage].key, shown.title))
            film = kept or _draw(run, family, config, kind, shown, say)
            drawn.append({**film, "choice": shown.choice})
    write_record(run.root / FILMS, {"schema": SCHEMA, "films": drawn})


def _shown(
    run: RunFolder, family: OwnFamily, config: ExperimentConfig, initial: Sequence[Trials]
) -> Iterator[_Shown]:
    variants = np.unique(initial[0].variant, axis=0)
    rates = _rates(initial, variants)
    worst = variants[np.flatnonzero(rates == rates.min())[-1]]
    apart = arms_apart(run, config.networks, lambda tested: -_rates(initial, tested))
    is_worst = apart is not None and apart.is_on(worst)
    space = family.space(config.env)

    def told(variant: FloatArray) -> str:
        return ", ".join(f"{name} {_told(value)}" for name, value in space.named(variant).items())

    yield _Shown(
        variant=worst,
        told=told(worst),
        title=f"The variant that the initial networks did worst on, {told(worst)}",
        choice="On it the arms differ most, too." if is_worst else "",
        kinds=tuple(TRIALS),
        suffix="",
    )
    if apart is not None and not is_worst:
        yield _Shown(
            variant=apart.variant,
            told=told(apart.variant),
            title=f"{TITLE}, {told(apart.variant)}",
            choice=apart.rule,
            kinds=ARMS,
            suffix="-apart",
        )


def _draw(
    run: RunFolder,
    family: OwnFamily,
    config: ExperimentConfig,
    kind: str,
    shown: _Shown,
    say: Callable[[str], None],
) -> dict[str, Any]:
    """Draw one film and its sheet, and return its record."""
    stage = per_network(TRIALS[kind], NETWORK)
    network = run.stages[per_network(kind, NETWORK)].path(NETWORK_FILE)
    (episode,) = film_network(
        network,
        family,
        variants=[shown.variant],
        seed=config.seed,
        deterministic=config.tests.deterministic,
        settings=config.env,
        most_frames=MOST_FRAMES,
        most_px=MOST_PX,
    )
    film, sheet = (
        run.root / FILM_FOLDER / f"{kind}{shown.suffix}{ending}" for ending in (".mp4", ".png")
    )
    duration_s = episode.steps * episode.step_s
    fps = _fps(len(episode.frames), duration_s)
    write_mp4(film, episode.frames, fps)
    write_png(sheet, _sheet(episode))
    outcome = "succeeded" if episode.is_success else "failed"
    say(f"{film}: {shown.told}: {outcome}")
    trials = read_trials(run.stages[stage].path(TRIALS_FILE))
    alike = _on(trials, shown.variant)
    return {
        "kind": kind,
        "stage": stage,
        "key": run.stages[stage].key,
        "variant": shown.title,
        "rule": RULE,
        "caption": f"{shown.told}, {episode.steps} steps",
        "outcome": f"{outcome} after {duration_s:.3g} s",
        "network": NETWORK,
        "successes": int(trials.success[alike].sum()),
        "trials": int(alike.sum()),
        "speed": duration_s * fps / max(1, len(episode.frames) - 1),
        "film": file_of_film(film),
        "sheet": file_of_film(sheet),
        "duration_s": duration_s,
    }


def _initial_trials(run: RunFolder, networks: int) -> list[Trials]:
    """Return the trials of the initial networks, as far as they were made."""
    stages = [per_network(TRIALS[INITIATION], network) for network in range(networks)]
    return [
        read_trials(run.stages[name].path(TRIALS_FILE)) for name in stages if name in run.stages
    ]


def _rates(tables: Sequence[Trials], variants: FloatArray) -> FloatArray:
    """Return the success on each variant over all tables, shape ``(variant,)``."""
    return np.array(
        [
            np.concatenate([table.success[_on(table, variant)] for table in tables]).mean()
            for variant in variants
        ]
    )


def _on(trials: Trials, variant: FloatArray) -> Any:
    """Return which trials were made on a variant, ``(trial,)``."""
    return np.isclose(trials.variant, variant).all(axis=1)


def _fps(frames: int, duration_s: float) -> int:
    """Return frames per second for an episode that took so long."""
    return int(np.clip(round((frames - 1) / min(duration_s, LONGEST_S)), 1, MOST_FPS))


def _sheet(episode: FilmedEpisode) -> Frame:
    rows, columns = MOMENTS
    moments = np.linspace(0, len(episode.frames) - 1, rows * columns).round().astype(int)
    shown = [episode.frames[moment] for moment in moments]
    return np.concatenate(
        [np.concatenate(shown[row * columns : (row + 1) * columns], axis=1) for row in range(rows)]
    )


def _told(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
