"""The films of a run as its page needs them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.errors import IntegrityError
from surmount.core.records import file_hash, read_record, write_record
from surmount.report.film_choice import Shown
from surmount.trials.table import read_trials
from surmount.trials.trials import Trials
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import (
    FILM_FOLDER,
    FILMS,
    SCHEMA,
    TRIALS,
    TRIALS_FILE,
    per_network,
    read_run_record,
)

NETWORK = 0
"""The network that is filmed: always the first."""

FIRST_TRIAL = "always the first trial of the first network, whatever happened in it"
"""What is shown where a record names no rule."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmedTrial:
    """One trial on film.

    Attributes
    ----------
    kind
        What had been learnt: ``"initiation"``, ``"curriculum"`` or ``"control"``.
    variant
        Which variant is shown, in words.
    rule
        Which trial of it is always chosen, in words.
    choice
        Why this variant is shown, as a sentence; empty where its title says so.
    caption, outcome
        Which trial it is, and how it ended.
    successes, trials
        Of the same network on this variant.
    speed
        Speed of the film against real time.
    mp4, png
        The film and its moments.
    """

    kind: str
    variant: str
    rule: str
    choice: str
    caption: str
    outcome: str
    successes: int
    trials: int
    speed: float
    mp4: bytes
    png: bytes


def read_films(run: RunFolder) -> tuple[FilmedTrial, ...]:
    """Read the films of a run; none where none were drawn of the trials it holds now.

    Raises
    ------
    IntegrityError
        If a film is missing or was changed after it was drawn.
    InputError
        If the record of the films cannot be read.
    """
    root = run.root
    if not (root / FILMS).is_file():
        return ()
    records = cast("list[dict[str, Any]]", read_run_record(root / FILMS)["films"])
    keys = {name: artefact.key for name, artefact in run.stages.items()}
    return tuple(
        FilmedTrial(
            kind=str(record["kind"]),
            variant=_title(record),
            rule=str(record.get("rule") or FIRST_TRIAL),
            choice=str(record.get("choice") or ""),
            caption=str(record["caption"]),
            outcome=str(record["outcome"]),
            successes=int(record["successes"]),
            trials=int(record["trials"]),
            speed=float(record["speed"]),
            mp4=_content(root, record["film"]),
            png=_content(root, record["sheet"]),
        )
        for record in records
        if keys.get(record["stage"]) == record["key"]
    )


def hardest_title(size_mm: float) -> str:
    """Return how the hardest variant of an obstacle is called."""
    return f"The hardest variant, {size_mm:g} mm"


@dataclass(frozen=True, kw_only=True, eq=False)
class Wanted:
    """A film that is to be drawn, of the trials of one stage.

    Attributes
    ----------
    shown
        The variant.
    kind, stage
        What had been learnt, and the name of the stage whose trials are shown.
    trials
        These.
    film, sheet
        Where the film and its moments go.
    """

    shown: Shown
    kind: str
    stage: str
    trials: Trials
    film: Path
    sheet: Path


def draw_wanted(
    run: RunFolder, shown: Iterable[Shown], draw: Callable[[Wanted], dict[str, Any]]
) -> None:
    """Draw the films that a run lacks, of its first network, and write the record of all.

    Parameters
    ----------
    run
        The run.
    shown
        The variants to show.
    draw
        Writes a film and its sheet, and returns what its own record holds besides: ``caption``,
        ``outcome``, ``speed``, ``duration_s``.
    """
    earlier = _kept(run)
    drawn: list[dict[str, Any]] = []
    for one in shown:
        for kind in one.kinds:
            stage = per_network(TRIALS[kind], NETWORK)
            if stage not in run.stages:
                continue
            film = earlier.get((run.stages[stage].key, one.title)) or _drawn(
                run, one, kind, stage, draw
            )
            drawn.append({**film, "variant": one.title, "choice": one.choice})
    write_record(run.root / FILMS, {"schema": SCHEMA, "films": drawn})


def _drawn(
    run: RunFolder, shown: Shown, kind: str, stage: str, draw: Callable[[Wanted], dict[str, Any]]
) -> dict[str, Any]:
    trials = read_trials(run.stages[stage].path(TRIALS_FILE))
    name = f"{kind}-apart" if shown.is_second else kind
    film, sheet = (run.root / FILM_FOLDER / f"{name}{ending}" for ending in (".mp4", ".png"))
    wanted = Wanted(shown=shown, kind=kind, stage=stage, trials=trials, film=film, sheet=sheet)
    own = draw(wanted)
    alike = on_variant(trials, shown.variant)
    return {
        **own,
        "kind": kind,
        "stage": stage,
        "key": run.stages[stage].key,
        "network": NETWORK,
        "successes": int(trials.success[alike].sum()),
        "trials": int(alike.sum()),
        "film": _file(film),
        "sheet": _file(sheet),
    }


def on_variant(trials: Trials, variant: FloatArray) -> BoolArray:
    """Return which trials were made on a variant, ``(trial,)``."""
    return np.all(np.isclose(trials.variant, variant), axis=1)


def _file(path: Path) -> dict[str, str]:
    return {"name": path.name, "sha256": file_hash(path)}


def _kept(run: RunFolder) -> dict[tuple[str, str], dict[str, Any]]:
    """Return the records of films that still are what was drawn, by key of trials and variant."""
    if not (run.root / FILMS).is_file():
        return {}
    record = read_record(run.root / FILMS)
    if record.get("schema") != SCHEMA:
        return {}
    films = record["films"]
    return {(film["key"], _title(film)): film for film in films if _is_whole(run, film)}


def _title(record: dict[str, Any]) -> str:
    return str(record.get("variant") or hardest_title(record["size_mm"]))


def _is_whole(run: RunFolder, film: dict[str, Any]) -> bool:
    files = [
        (run.root / FILM_FOLDER / file["name"], file) for file in (film["film"], film["sheet"])
    ]
    return all(path.is_file() and file_hash(path) == file["sha256"] for path, file in files)


def _content(root: Path, file: dict[str, str]) -> bytes:
    path = root / FILM_FOLDER / Path(file["name"]).name
    if not path.is_file() or file_hash(path) != file["sha256"]:
        raise IntegrityError(
            f"{path} is missing or was changed after it was drawn.",
            remedy=f"Delete {root / FILM_FOLDER} and ask for the report again.",
        )
    return path.read_bytes()
