"""What a run writes down about its stages as they end: where they are, how they came about."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from surmount.core.records import sealed, write_record
from surmount.workflow.run_layout import (
    INDEX,
    RESTARTS,
    SCHEMA,
    TIMINGS,
    read_index,
    read_numbers,
)
from surmount.workflow.runner import RunObserver
from surmount.workflow.store import Artefact, is_inside


class Journal:
    """Writes down each stage's folder and seconds, and workers that were lost, as it happens.

    Parameters
    ----------
    root
        The output folder.
    observer
        Told the same.
    """

    def __init__(self, root: Path, observer: RunObserver) -> None:
        self._root = root
        self._observer = observer
        self._stages = _kept(root)
        self._seconds = read_numbers(root / TIMINGS)
        self._restarts = read_numbers(root / RESTARTS)

    def stage_reused(self, artefact: Artefact) -> None:
        """Write down where an earlier call left the stage."""
        self._index(artefact)
        self._observer.stage_reused(artefact)

    def stage_outdated(self, stage: str, folders: Sequence[Path]) -> None:
        """Pass it on."""
        self._observer.stage_outdated(stage, folders)

    def stage_started(self, stage: str) -> None:
        """Pass it on."""
        self._observer.stage_started(stage)

    def stage_finished(self, artefact: Artefact, seconds: float) -> None:
        """Write down how long the stage took, and where it is."""
        self._seconds[artefact.stage] = round(seconds, 3)
        write_record(self._root / TIMINGS, self._seconds)
        self._index(artefact)
        self._observer.stage_finished(artefact, seconds)

    def stage_lost(self, stage: str, *, again: bool) -> None:
        """Count the workers that a stage lost."""
        self._restarts[stage] = self._restarts.get(stage, 0) + 1
        write_record(self._root / RESTARTS, self._restarts)
        self._observer.stage_lost(stage, again=again)

    def _index(self, artefact: Artefact) -> None:
        self._stages[artefact.stage] = artefact.folder.relative_to(self._root).as_posix()
        stages = dict(sorted(self._stages.items()))
        write_record(self._root / INDEX, sealed({"schema": SCHEMA, "stages": stages}))


def _kept(root: Path) -> dict[str, str]:
    """Return what earlier calls indexed: a comparison of teachers has more stages than a run."""
    kept = read_index(root) or {}
    return {
        name: folder
        for name, folder in kept.items()
        if is_inside(folder) and os.path.isdir(root / folder)  # noqa: PTH112 - also false for a name that no system takes
    }
