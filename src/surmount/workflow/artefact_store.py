"""Where a run's stages are kept: the output folder, and beside it, if wanted, an object store."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from surmount.core.errors import IntegrityError
from surmount.workflow.monitor import Monitor, Progress
from surmount.workflow.object_store import ObjectStore
from surmount.workflow.provenance import made_with
from surmount.workflow.store import Artefact, LocalStore


@dataclass(frozen=True, kw_only=True)
class ArtefactStore:
    """An output folder and an object store that hold the same stages.

    Attributes
    ----------
    root
        The output folder; on a worker without it, a folder of its own.
    url
        The object store; ``None`` where every worker sees the output folder.
    """

    root: Path
    url: str | None = None

    @property
    def store(self) -> LocalStore:
        """The stages in the output folder."""
        return LocalStore(self.root)

    def elsewhere(self, root: Path) -> ArtefactStore:
        """Return the depot as a worker sees it that has another folder."""
        return replace(self, root=root)

    def find(self, stage: str, key: str) -> Artefact | None:
        """Return a finished stage, brought from the object store where only that has it."""
        found = self.store.find(stage, key)
        if self.url is None:
            return found
        remote = ObjectStore(self.url)
        if found is None:
            return remote.pull(stage, key, self.store)
        if not remote.has(stage, key):
            remote.push(found)
        return found

    def bring(self, artefact: Artefact) -> Artefact:
        """Return a stage that was finished somewhere, as it is in the output folder.

        Raises
        ------
        IntegrityError
            If it is not here, or not the same.
        """
        found = self.store.find(artefact.stage, artefact.key)
        if found is None and self.url is not None:
            found = ObjectStore(self.url).pull(artefact.stage, artefact.key, self.store)
        if found is None or found.content_hash != artefact.content_hash:
            raise IntegrityError(
                f"Stage `{artefact.stage}` was finished, but {self.root} does not hold it.",
                remedy="Give an --out folder that all workers see under the same path, or an "
                "object store by --store.",
            )
        return found

    def commit(
        self, workspace: Path, stage: str, key: str, *, inputs: Mapping[str, str]
    ) -> Artefact:
        """Publish a workspace as the finished stage, and drop the stage's checkpoint."""
        artefact = self.store.commit(workspace, stage, key, inputs=inputs, made_with=made_with())
        if self.url is not None:
            ObjectStore(self.url).push(artefact)
        return artefact

    def checkpoints(self, stage: str, key: str) -> Checkpoints:
        """Return the checkpoints of an unfinished stage, with the newest in their folder."""
        folder = self.store.checkpoint_folder(stage, key)
        folder.mkdir(parents=True, exist_ok=True)
        if self.url is not None and not any(folder.iterdir()):
            ObjectStore(self.url).pull_checkpoint(stage, key, folder)
        return Checkpoints(self, stage, key, folder)


class Checkpoints:
    """The checkpoints of one unfinished stage, copied to the object store as they appear."""

    def __init__(self, depot: ArtefactStore, stage: str, key: str, folder: Path) -> None:
        self._depot = depot
        self._stage = stage
        self._key = key
        self.folder = folder
        self._saved = self._signature()

    def watched(self, monitor: Monitor) -> Monitor:
        """Return a monitor that copies a new checkpoint whenever it is told of progress."""
        return monitor if self._depot.url is None else _Watching(monitor, self)

    def save(self) -> None:
        """Copy the checkpoint to the object store, if there is one and it is new there."""
        signature = self._signature()
        if self._depot.url is None or signature == self._saved:
            return
        ObjectStore(self._depot.url).push_checkpoint(self._stage, self._key, self.folder)
        self._saved = signature

    def _signature(self) -> list[tuple[str, int, int]]:
        """Return what changes with every checkpoint: each is a new file with an old name."""
        if self._depot.url is None:
            return []
        stats = [(path.name, path.stat()) for path in sorted(self.folder.iterdir())]
        return [(name, stat.st_ino, stat.st_mtime_ns) for name, stat in stats]


class _Watching:
    def __init__(self, monitor: Monitor, checkpoints: Checkpoints) -> None:
        self._monitor = monitor
        self._checkpoints = checkpoints

    def progress(self, progress: Progress) -> None:
        self._checkpoints.save()
        self._monitor.progress(progress)

    def log(self, sentence: str) -> None:
        self._monitor.log(sentence)

    def should_stop(self) -> bool:
        return self._monitor.should_stop()
