"""Films of a run on somebody's own environment, for its page: drawn by the environment itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.envs.own_family import OwnFamily
from surmount.envs.video import Frame, write_mp4, write_png
from surmount.experiment.config import config_from_record
from surmount.experiment.own_films import FilmedEpisode, can_draw, film_network
from surmount.report.film_choice import arms_apart, shown_variants
from surmount.report.films import NETWORK, Wanted, draw_wanted, on_variant
from surmount.trials.table import read_trials
from surmount.trials.trials import Trials
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import (
    INITIATION,
    NETWORK_FILE,
    TRIALS,
    TRIALS_FILE,
    per_network,
)

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
    variants = np.unique(initial[0].variant, axis=0)
    rates = _rates(initial, variants)
    worst = variants[np.flatnonzero(rates == rates.min())[-1]]
    apart = arms_apart(run, config.networks, lambda tested: -_rates(initial, tested))
    space = family.space(config.env)

    def told(variant: FloatArray) -> str:
        return ", ".join(f"{name} {_told(value)}" for name, value in space.named(variant).items())

    title = f"The variant that the initial networks did worst on, {told(worst)}"

    def draw(wanted: Wanted) -> dict[str, Any]:
        variant = wanted.shown.variant
        (episode,) = film_network(
            run.stages[per_network(wanted.kind, NETWORK)].path(NETWORK_FILE),
            family,
            variants=[variant],
            seed=config.seed,
            deterministic=config.tests.deterministic,
            settings=config.env,
            most_frames=MOST_FRAMES,
            most_px=MOST_PX,
        )
        duration_s = episode.steps * episode.step_s
        fps = _fps(len(episode.frames), duration_s)
        write_mp4(wanted.film, episode.frames, fps)
        write_png(wanted.sheet, _sheet(episode))
        outcome = "succeeded" if episode.is_success else "failed"
        say(f"{wanted.film}: {told(variant)}: {outcome}")
        return {
            "rule": RULE,
            "caption": f"{told(variant)}, {episode.steps} steps",
            "outcome": f"{outcome} after {duration_s:.3g} s",
            "speed": duration_s * fps / max(1, len(episode.frames) - 1),
            "duration_s": duration_s,
        }

    draw_wanted(run, shown_variants(worst, title, apart, told), draw)


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
            np.concatenate([table.success[on_variant(table, variant)] for table in tables]).mean()
            for variant in variants
        ]
    )


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
