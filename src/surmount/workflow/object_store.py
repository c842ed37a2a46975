"""Finished stages and checkpoints in an object store, wherever fsspec reaches.

Layout below the URL::

    stages/<stage>/<key>/…                 files of a finished stage; manifest.json comes last
    checkpoints/<stage>/<key>/<hash>       files of the newest checkpoint
    checkpoints/<stage>/<key>/current.json names and hashes of these

A folder without a manifest is not there. Whatever comes back is checked against the hashes of its
manifest before it gets its name, and no name in a manifest may lead out of its folder.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from surmount.core.errors import ConfigError, IntegrityError, OutputError, SurmountError
from surmount.core.records import canonical_json, file_hash, parse_json, parse_sealed
from surmount.workflow.store import (
    KEY_LENGTH,
    MANIFEST,
    MANIFEST_KEYS,
    Artefact,
    LocalStore,
    files_of,
    is_index,
)

CURRENT = "current.json"


class ObjectStore:
    """Stages below a URL such as ``s3://bucket/run`` or ``file:///shared/run``.

    Parameters
    ----------
    url
        Any that fsspec knows; what reaches it (s3fs, gcsfs, …) has to be installed.

    Raises
    ------
    ConfigError
        If the URL cannot be used.
    """

    def __init__(self, url: str) -> None:
        import fsspec  # noqa: PLC0415 - an extra

        self._url = url
        try:
            found = fsspec.core.url_to_fs(url)
        except (ValueError, ImportError, OSError) as error:
            raise ConfigError(
                f"The object store {url} cannot be used ({error}).",
                remedy="Give a URL that fsspec knows, such as s3://bucket/run, and install what "
                "reaches it, such as s3fs.",
            ) from error
        self._files: Any = found[0]
        self._base = str(found[1]).rstrip("/")

    def has(self, stage: str, key: str) -> bool:
        """Whether a finished stage is here."""
        with self._errors():
            return self._manifest(self._stage(stage, key)) is not None

    def pull(self, stage: str, key: str, store: LocalStore) -> Artefact | None:
        """Bring a finished stage into a local store, or return ``None`` if it is not here.

        Raises
        ------
        IntegrityError
            If a file does not fit the manifest.
        """
        base = self._stage(stage, key)
        with self._errors():
            content = self._manifest(base)
        if content is None:
            return None
        source, remedy = f"{base}/{MANIFEST} in the object store", _remedy(base)
        manifest = parse_sealed(content, source, MANIFEST_KEYS, remedy=remedy)
        index = files_of(manifest, stage, key, source, remedy=remedy)
        workspace = store.workspace(stage, key)
        for name, digest in index.items():
            self._fetch(f"{base}/{name}", workspace / name, digest, base)
        artefact = store.publish(workspace, manifest)
        store.drop_checkpoint(stage, key)
        return artefact

    def push(self, artefact: Artefact) -> None:
        """Keep a finished stage here, the manifest last, and drop its checkpoint."""
        base = self._stage(artefact.stage, artefact.key)
        with self._errors():
            for name in [*artefact.files, MANIFEST]:
                path = artefact.folder / MANIFEST if name == MANIFEST else artefact.path(name)
                self._send(path, f"{base}/{name}")
            checkpoint = self._checkpoint(artefact.stage, artefact.key)
            if self._files.exists(checkpoint):
                self._files.rm(checkpoint, recursive=True)

    def push_checkpoint(self, stage: str, key: str, folder: Path) -> None:
        """Keep the files of a checkpoint, replacing the last one at once."""
        base = self._checkpoint(stage, key)
        index = {
            path.name: file_hash(path)
            for path in sorted(folder.iterdir())
            if path.is_file() and not path.name.startswith(".")
        }
        with self._errors():
            for name, digest in index.items():
                self._send(folder / name, f"{base}/{digest}")
            self._files.pipe_file(f"{base}/{CURRENT}", canonical_json(index).encode())
            keep = {CURRENT, *index.values()}
            for path in self._files.ls(base, detail=False):
                if str(path).rpartition("/")[2] not in keep:
                    self._files.rm_file(path)

    def pull_checkpoint(self, stage: str, key: str, folder: Path) -> bool:
        """Bring the newest checkpoint into a folder; false if there is none that is whole."""
        base = self._checkpoint(stage, key)
        with self._errors():
            if not self._files.exists(f"{base}/{CURRENT}"):
                return False
            try:
                index = parse_json(self._files.cat_file(f"{base}/{CURRENT}").decode())
            except (ValueError, RecursionError):
                return False
        if not is_index(index):
            return False
        try:
            for name, digest in index.items():
                self._fetch(f"{base}/{digest}", folder / name, digest, base)
        except (IntegrityError, OutputError):
            for name in index:
                (folder / name).unlink(missing_ok=True)
            return False
        return bool(index)

    def _manifest(self, base: str) -> bytes | None:
        """Return a stage's manifest; ``None`` where there is none, or one that was torn.

        A store that does not keep objects whole may have a part of one: the stage was not sent to
        its end, and is sent again.
        """
        path = f"{base}/{MANIFEST}"
        if not self._files.exists(path):
            return None
        content = self._files.cat_file(path)
        return content if content.rstrip().endswith(b"}") else None

    def _send(self, path: Path, target: str) -> None:
        """Send a file, and see that all of it has come.

        Raises
        ------
        OSError
            If the store has less of it, or more.
        """
        self._files.makedirs(target.rpartition("/")[0], exist_ok=True)
        self._files.put_file(str(path), target)
        self._files.invalidate_cache()
        sent, arrived = path.stat().st_size, self._files.size(target)
        if arrived not in (sent, None):  # some stores do not tell
            raise OSError(f"of {target}, {arrived:,} of {sent:,} bytes have arrived")

    def _fetch(self, source: str, path: Path, digest: str, base: str) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        with self._errors():
            self._files.get_file(source, str(path))
        if file_hash(path) != digest:
            path.unlink()
            raise self._damaged(source, base)

    def _damaged(self, what: str, base: str) -> IntegrityError:
        return IntegrityError(
            f"{what} in the object store was changed or damaged: its hash does not fit.",
            remedy=_remedy(base),
        )

    def _stage(self, stage: str, key: str) -> str:
        return f"{self._base}/stages/{stage}/{key[:KEY_LENGTH]}"

    def _checkpoint(self, stage: str, key: str) -> str:
        return f"{self._base}/checkpoints/{stage}/{key[:KEY_LENGTH]}"

    @contextmanager
    def _errors(self) -> Generator[None]:
        """Turn what an object store refuses into one sentence; each has errors of its own."""
        try:
            yield
        except SurmountError:
            raise
        except Exception as error:
            raise OutputError(
                f"The object store {self._url} refused ({type(error).__name__}: {error}).",
                remedy="Check that it is reachable, and that this account may read and write it; "
                "finished work is kept, and the same command goes on.",
            ) from error


def _remedy(base: str) -> str:
    return f"Delete {base} there and run again: only this stage is repeated."
