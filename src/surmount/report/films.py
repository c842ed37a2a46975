"""The films of a run as its page needs them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from surmount.core.errors import IntegrityError
from surmount.core.records import file_hash
from surmount.workflow.run_folder import RunFolder
from surmount.workflow.run_layout import FILM_FOLDER, FILMS, read_run_record


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmedTrial:
    """One trial on film.

    Attributes
    ----------
    kind
        What had been learnt: ``"initiation"``, ``"curriculum"`` or ``"control"``.
    size_mm
        Size of the obstacle.
    caption, outcome
        Which trial it is, and how it ended.
    successes, trials
        Of the same network on this size.
    speed
        Speed of the film against real time.
    mp4, png
        The film and its moments.
    """

    kind: str
    size_mm: float
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
            size_mm=float(record["size_mm"]),
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


def _content(root: Path, file: dict[str, str]) -> bytes:
    path = root / FILM_FOLDER / Path(file["name"]).name
    if not path.is_file() or file_hash(path) != file["sha256"]:
        raise IntegrityError(
            f"{path} is missing or was changed after it was drawn.",
            remedy=f"Delete {root / FILM_FOLDER} and ask for the report again.",
        )
    return path.read_bytes()
