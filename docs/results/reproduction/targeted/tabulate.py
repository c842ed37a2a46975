"""Compare runs that differ in seed or in W of eq. 5: ``python tabulate.py OUT RUN [RUN ...]``.

Writes ``levels.csv``, one row per level (how long it lasted, its first gain, the noise that the
run's page sets beside it, and how often the level's own group succeeded in training when the level
was left), and ``success.csv``, one row per network, group and training.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import polars as pl

from surmount.report.results import RunResults, read_run
from surmount.report.sections.gain_noise import CLEAR, noise_of_test
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.regions import Regions

NEWEST_STEPS = 200_000
"""Learning steps before the end of a level over which its own group's episodes are counted."""


def levels(results: RunResults) -> list[dict[str, Any]]:
    """Return one row per network and level."""
    curriculum, settings = _curriculum(results), _settings(results)
    rows: list[dict[str, Any]] = []
    names = [group.name for group in curriculum.groups]
    for network, training in sorted(results.trainings["curriculum"].items()):
        episodes = training.record
        groups = Regions.of(curriculum).index(episodes.tasks)
        begun = 0
        for level in sorted({test.level for test in training.level_tests}):
            tests = [test for test in training.level_tests if test.level == level]
            first, last = tests[0], tests[-1]
            since = max(begun, last.steps - NEWEST_STEPS)
            own = groups == names.index(curriculum.levels[level].dominant)
            own &= episodes.steps > since
            own &= episodes.steps <= last.steps
            noise = noise_of_test(first, training, settings["window_steps"])
            told = None not in (noise, first.first_gain)
            clear = abs(first.first_gain) >= CLEAR * noise if told else None
            rows.append(settings | {
                "network": network,
                "level": level + 1,
                "iterations": len(tests),
                "level_steps": last.steps - begun,
                "first_gain": first.first_gain,
                "noise": noise,
                "clear_of_chance": clear,
                "own_group_episodes": int(own.sum()),
                "own_group_success": float(episodes.success[own].mean()),
            })  # fmt: skip
            begun = last.steps
    return rows


def success(results: RunResults) -> list[dict[str, Any]]:
    """Return one row per network, group and training."""
    curriculum, settings = _curriculum(results), _settings(results)
    rows: list[dict[str, Any]] = []
    for learnt, outcomes in results.tests.items():
        groups = curriculum.groups_of(outcomes.variant)
        for network in sorted(set(outcomes.network.tolist())):
            own = outcomes.network == network
            rows += [
                settings | {
                    "network": network,
                    "group": group.name,
                    "learnt": learnt,
                    "success": float(outcomes.success[own & (groups == index)].mean()),
                }
                for index, group in enumerate(curriculum.groups)
            ]  # fmt: skip
    return rows


def _curriculum(results: RunResults) -> Curriculum:
    return results.analysis.curriculum


def _settings(results: RunResults) -> dict[str, int]:
    config = results.folder.config
    return {
        "seed": int(config["seed"]),
        "window_steps": int(config["advancement"]["window_steps"]),
    }


def tabulate(folder: Path, *runs: Path) -> None:
    """Write both tables."""
    results = [read_run(run) for run in runs]
    folder.mkdir(parents=True, exist_ok=True)
    for name, table in (("levels", levels), ("success", success)):
        rows = pl.DataFrame([row for run in results for row in table(run)])
        rows.sort(rows.columns[:5]).write_csv(folder / f"{name}.csv", float_precision=4)


if __name__ == "__main__":
    tabulate(*map(Path, sys.argv[1:]))
