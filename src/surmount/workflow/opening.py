"""The one way to open a file that may be an artefact of a run: after checking its hash."""

from __future__ import annotations

import os
import re
from pathlib import Path

from surmount.core.records import read_sealed
from surmount.workflow.store import KEY_LENGTH, MANIFEST, MANIFEST_KEYS, Artefact, LocalStore

_KEY = re.compile(f"[0-9a-f]{{{KEY_LENGTH}}}")


def opened(path: Path) -> Path:
    """Return the path of a file, after checking its content where a run vouches for it.

    Raises
    ------
    IntegrityError
        If it is an artefact of a run and does not have the content that its hash promises, or that
        run's manifest of it was changed.
    """
    for found in dict.fromkeys((Path(os.path.abspath(path)), path.resolve())):  # noqa: PTH100
        artefact = artefact_of(found)
        if artefact is not None:
            name = found.relative_to(artefact.folder).as_posix()
            if name in artefact.files:
                artefact.path(name)
    return path


def artefact_of(path: Path) -> Artefact | None:
    """Return the finished stage that a file lies in, or ``None`` where it lies in none.

    Parameters
    ----------
    path
        An absolute path.

    Raises
    ------
    IntegrityError
        If the stage's manifest is missing, or was changed or damaged.
    """
    for folder in path.parents:
        parts = folder.parts
        if not _KEY.fullmatch(folder.name) or "stages" not in parts:
            continue
        base = len(parts) - 1 - parts[::-1].index("stages")
        manifest = read_sealed(
            folder / MANIFEST,
            MANIFEST_KEYS,
            remedy=f"Delete {folder} and run again: only this stage is repeated.",
        )
        root, stage = Path(*parts[:base]), "/".join(parts[base + 1 : -1])
        return LocalStore(root).find(stage, str(manifest.get("key")))
    return None
