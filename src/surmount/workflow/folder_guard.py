"""Notices that an output folder, or what was finished in it, was removed while a run is at work."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Self

from surmount.core.errors import OutputError
from surmount.workflow.store import MANIFEST, Artefact


class FolderGuard:
    """Holds a folder open, so that another of its name is not taken for it.

    Parameters
    ----------
    root
        The output folder; made where it does not exist.
    """

    def __init__(self, root: Path) -> None:
        self._root = root
        self._descriptor = -1

    def __enter__(self) -> Self:
        self._root.mkdir(parents=True, exist_ok=True)
        self._descriptor = os.open(self._root, os.O_RDONLY)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        os.close(self._descriptor)

    def check(self, finished: Iterable[Artefact]) -> None:
        """See that the folder is the one that was opened, and still holds what was finished.

        Raises
        ------
        OutputError
            Naming what is not there any more.
        """
        held = os.fstat(self._descriptor)
        try:
            same = os.path.samestat(held, self._root.stat())
        except OSError:
            same = False
        gone = (
            artefact.folder for artefact in finished if not (artefact.folder / MANIFEST).is_file()
        )
        missing = next(gone, None) if same else self._root
        if missing is not None:
            raise OutputError(
                f"{missing} was removed or replaced while the run was at work.",
                remedy="Run the same command again, and leave the folder alone while it is used: "
                "what is still there is kept.",
            )
