"""The artefact store: what each finished stage left, addressed by what it was made from.

Layout below the output folder::

    stages/<stage name>/<key>/        the files of one finished stage
    stages/<stage name>/<key>/manifest.json   stage, key, inputs, and the SHA-256 of every file
    checkpoints/<stage name>/<key>/   the latest checkpoint of an unfinished stage

A stage's folder appears by one rename when all its files are written, so a folder that exists is
complete. The key is the hash of everything the stage depends on.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import re
import secrets
import shutil
from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from surmount.core.errors import IntegrityError, OutputError, SurmountError
from surmount.core.records import (
    file_hash,
    read_sealed,
    record_hash,
    sealed,
    synchronise,
    write_record,
)

MANIFEST = "manifest.json"
MANIFEST_KEYS = ("schema", "stage", "key", "inputs", "files", "made_with")
SCHEMA = 1
KEY_LENGTH = 16
"""Hexadecimal digits of a key that name a folder: 64 bits."""
_WHOLE = ".whole"
"""Stands in a workspace until it is published: gone where the workspace was removed meanwhile."""
_TEMPORARY = re.compile(r"\..+\.[0-9a-f]{8}\.tmp")
"""Names of what is not finished; see :func:`surmount.core.records.write_atomically`."""


@dataclass(frozen=True, kw_only=True)
class Artefact:
    """The files of one finished stage.

    Attributes
    ----------
    stage
        Name of the stage, for example ``"initiation/network-0"``.
    key
        Hash of what the stage was made from.
    folder
        Where the files are.
    files
        SHA-256 of each file by its name.
    made_with
        Versions and kind of machine, where recorded.
    """

    stage: str
    key: str
    folder: Path
    files: Mapping[str, str]
    made_with: Mapping[str, str] = field(default_factory=dict[str, str], compare=False)

    @property
    def content_hash(self) -> str:
        """Hash over the names and contents of all files."""
        return record_hash(dict(self.files))

    def path(self, name: str) -> Path:
        """Return the path of a file after checking its content against its hash.

        Raises
        ------
        IntegrityError
            If the stage has no such file, or its content does not fit.
        """
        path = self.folder / name
        if name not in self.files:
            raise IntegrityError(
                f"Stage `{self.stage}` has no file `{name}` in {self.folder}.",
                remedy=f"Delete {self.folder} and run again: only this stage is repeated.",
            )
        if not path.is_file() or path.is_symlink() or file_hash(path) != self.files[name]:
            raise IntegrityError(
                f"{path} was changed or damaged after it was written: its hash does not fit.",
                remedy=f"Delete {self.folder} and run again: only this stage is repeated.",
            )
        return path

    def verify(self) -> None:
        """Check every file against its hash.

        Raises
        ------
        IntegrityError
            Naming the first whose content does not fit.
        """
        for name in self.files:
            self.path(name)


class LocalStore:
    """Finished stages and checkpoints below one output folder."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def find(self, stage: str, key: str) -> Artefact | None:
        """Return the finished stage of this key, or ``None`` if it has not been run.

        Raises
        ------
        IntegrityError
            If the folder is not that stage's, or its manifest was changed.
        """
        folder = self._stage_folder(stage, key)
        if not folder.is_dir():
            return None
        if folder.is_symlink():
            raise IntegrityError(
                f"{folder} is a link, not a folder of this run.",
                remedy=f"Remove {folder} and run again: only this stage is repeated.",
            )
        remedy = f"Delete {folder} and run again: only this stage is repeated."
        manifest = read_sealed(folder / MANIFEST, MANIFEST_KEYS, remedy=remedy)
        return Artefact(
            stage=stage,
            key=key,
            folder=folder,
            files=files_of(manifest, stage, key, str(folder / MANIFEST), remedy=remedy),
            made_with=manifest.get("made_with") or {},
        )

    def others(self, stage: str, key: str) -> list[Path]:
        """Return the folders of what the stage left when it was made from something else."""
        folder = self._stage_folder(stage, key)
        if not folder.parent.is_dir():
            return []
        return sorted(
            other
            for other in folder.parent.iterdir()
            if other != folder and not other.name.startswith(".") and (other / MANIFEST).is_file()
        )

    def workspace(self, stage: str, key: str) -> Path:
        """Return an empty folder to write a stage's files to before :meth:`commit`.

        Its name is used once: two workers at the same stage, of which one is given up for lost,
        never write to the same files.
        """
        folder = self._stage_folder(stage, key)
        workspace = folder.with_name(f".{folder.name}.{secrets.token_hex(4)}.tmp")
        workspace.mkdir(parents=True)
        (workspace / _WHOLE).touch()
        return workspace

    def commit(
        self,
        workspace: Path,
        stage: str,
        key: str,
        *,
        inputs: Mapping[str, str],
        made_with: Mapping[str, str] | None = None,
    ) -> Artefact:
        """Publish a workspace as the finished stage, and drop the stage's checkpoint.

        Parameters
        ----------
        workspace
            From :meth:`workspace`, with the files of the stage.
        stage, key
            Which stage it is.
        inputs
            Content hashes of the stages it was made from.
        made_with
            Versions and kind of machine; no part of the content hash.
        """
        files = {
            path.relative_to(workspace).as_posix(): file_hash(path)
            for path in sorted(workspace.rglob("*"))
            if path.is_file() and path != workspace / _WHOLE
        }
        manifest = {
            "schema": SCHEMA,
            "stage": stage,
            "key": key,
            "inputs": dict(inputs),
            "files": files,
            "made_with": dict(made_with or {}),
        }
        artefact = self.publish(workspace, manifest)
        self.drop_checkpoint(stage, key)
        return artefact

    def publish(self, workspace: Path, manifest: Mapping[str, Any]) -> Artefact:
        """Give a workspace its manifest and its name, by one rename.

        Where another run finished the stage meanwhile, its files are kept: the key says that they
        are the same.

        Raises
        ------
        FileNotFoundError
            If the workspace was removed meanwhile, also where who writes there made it again:
            files of the stage are missing then.
        """
        stage, key = str(manifest["stage"]), str(manifest["key"])
        (workspace / _WHOLE).unlink()
        write_record(workspace / MANIFEST, sealed(manifest))
        for path in workspace.rglob("*"):
            synchronise(path)
        folder = self._stage_folder(stage, key)
        try:
            workspace.rename(folder)
        except OSError as error:
            if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
                raise
            shutil.rmtree(workspace)
        synchronise(folder.parent)
        for left in folder.parent.glob(f".{folder.name}.*.tmp"):  # by workers that were killed
            shutil.rmtree(left, ignore_errors=True)
        return Artefact(stage=stage, key=key, folder=folder, files=dict(manifest["files"]))

    def drop_checkpoint(self, stage: str, key: str) -> None:
        """Remove the checkpoint of a stage that is finished."""
        shutil.rmtree(self.checkpoint_folder(stage, key), ignore_errors=True)

    def checkpoint_folder(self, stage: str, key: str) -> Path:
        """Return the folder for checkpoints of an unfinished stage."""
        return self.root / "checkpoints" / stage / key[:KEY_LENGTH]

    def adopt_checkpoint(self, stage: str, old_key: str, key: str) -> None:
        """Give the checkpoint of an unfinished stage the key that the stage has now."""
        old, new = self.checkpoint_folder(stage, old_key), self.checkpoint_folder(stage, key)
        if old.is_dir() and not new.exists():
            old.rename(new)

    def _stage_folder(self, stage: str, key: str) -> Path:
        return self.root / "stages" / stage / key[:KEY_LENGTH]


def files_of(
    manifest: Mapping[str, Any], stage: str, key: str, source: str, *, remedy: str
) -> dict[str, str]:
    """Return the hashes of a stage's files, if the manifest is that stage's.

    Raises
    ------
    IntegrityError
        If it is another's, or names what no manifest may.
    """
    files: Any = manifest.get("files")
    if manifest.get("key") != key or manifest.get("stage") != stage or not is_index(files):
        raise IntegrityError(f"{source} does not belong to stage `{stage}`.", remedy=remedy)
    return dict(files)


def is_index(files: Any) -> bool:
    """Whether this maps names of files, all inside their folder, to hashes."""
    return isinstance(files, dict) and all(
        isinstance(name, str) and isinstance(digest, str) and is_inside(name) and _is_hash(digest)
        for name, digest in files.items()
    )


def is_inside(name: str) -> bool:
    """Whether a relative path with forward slashes stays within its folder."""
    parts = name.split("/")
    return not set(parts) & {"", ".", ".."} and "\\" not in name and "\0" not in name


def _is_hash(digest: str) -> bool:
    return len(digest) == 64 and set(digest) <= set("0123456789abcdef")


@contextlib.contextmanager
def sole_user(root: Path) -> Generator[None]:
    """Hold the output folder for one process.

    Raises
    ------
    OutputError
        If the folder cannot be written, another process is using it, or a link in it leads out.
    """
    with output_errors(root):
        root.mkdir(parents=True, exist_ok=True)
        refuse_links(root)
        lock = (root / ".lock").open("w", encoding="utf-8")
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise OutputError(
                f"Another process is working in {root}.",
                remedy="Wait for it to end, stop it, or choose another --out folder.",
            ) from error
        with output_errors(root):
            clear_unfinished(root)
        yield


def clear_unfinished(root: Path) -> None:
    """Remove what processes that were killed had begun to write and given no name yet."""
    for folder, names, files in os.walk(root):
        for name in [name for name in names if _TEMPORARY.fullmatch(name)]:
            shutil.rmtree(Path(folder, name), ignore_errors=True)
            names.remove(name)  # walked into no further
        for name in files:
            if _TEMPORARY.fullmatch(name):
                Path(folder, name).unlink(missing_ok=True)


def refuse_links(root: Path) -> None:
    """Refuse an output folder in which a link could lead what is written out of it.

    Raises
    ------
    OutputError
        Naming the first link.
    """
    for folder, names, files in os.walk(root):
        for name in (*names, *files):
            path = Path(folder, name)
            if path.is_symlink():
                raise OutputError(
                    f"{path} is a link: what is written there would leave the output folder.",
                    remedy="Remove the link, or give the folder it leads to as --out.",
                )


_OUTPUT_ERRNOS = {
    errno.ENOSPC: ("is full", "Free some space and run again: finished work is kept."),
    errno.EDQUOT: ("is over its quota", "Free some space and run again: finished work is kept."),
    errno.EROFS: ("is read-only", "Choose an --out folder that can be written."),
    errno.EACCES: ("may not be written", "Choose another --out folder or change its permissions."),
    errno.EPERM: ("may not be written", "Choose another --out folder or change its permissions."),
    errno.ENOTDIR: ("is not a folder", "Choose an --out path that is a folder or does not exist."),
    errno.ENOENT: (
        "cannot be made, or a part of it was removed meanwhile",
        "Choose an --out folder in a place that exists, and leave it alone while it is used.",
    ),
    errno.ENAMETOOLONG: ("has too long a name", "Choose a shorter --out path."),
    errno.EFBIG: (
        "may not hold so large a file",
        "Raise the limit on the size of files, or choose an --out folder elsewhere.",
    ),
    errno.EIO: ("is on a failing disk", "Choose an --out folder on another disk."),
    errno.EEXIST: ("is not a folder", "Choose an --out path that is a folder or does not exist."),
}


@contextlib.contextmanager
def output_errors(root: Path) -> Generator[None]:
    """Turn the operating system's refusals to write into an :class:`OutputError`."""
    try:
        yield
    except SurmountError:
        raise
    except Exception as error:
        number = _errno(error)
        if number not in _OUTPUT_ERRNOS:
            raise
        what, remedy = _OUTPUT_ERRNOS[number]
        name = getattr(error, "filename", None)
        place = "" if name in (None, str(root)) else f" ({name})"
        raise OutputError(f"The output folder {root} {what}{place}.", remedy=remedy) from error


def _errno(error: Exception) -> int | None:
    """Return the operating system's number of an error, also where a library wrapped it."""
    if isinstance(error, OSError) and error.errno is not None:
        return error.errno
    wrapped = re.search(r"\(os error (\d+)\)", str(error))  # as Rust's libraries print it
    return int(wrapped[1]) if wrapped else None
