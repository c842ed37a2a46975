"""A checksum that a Parquet file keeps of itself, looked at before anything else reads the file.

Parquet has none that readers check: of 400 files with one bit flipped, nine were read with another
value, and five let Polars' Rust code panic, which prints to standard error by itself.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import tempfile
from collections.abc import Generator
from pathlib import Path

from surmount.core.errors import InputError

_KEY = "surmount.sha256"
_NOTHING = "0" * 64
PLACE = {_KEY: _NOTHING}
"""Metadata to write into the file: where :func:`stamp` puts the checksum."""
# Key and value as Thrift's compact protocol has them: a string of 64 bytes follows the key.
_STORED = re.compile(re.escape(_KEY.encode()) + rb"\x18\x40([0-9a-f]{64})")
_PIECE = 1 << 20
_MOST_FOOTER = 64 << 20
_PANIC = b"panicked at"


def stamp(path: Path) -> None:
    """Write the checksum of everything else in the file into its place.

    Raises
    ------
    ValueError
        If the file was not written with :data:`PLACE`.
    """
    found = _found(path)
    if found is None:
        raise ValueError(f"{path} has no place for a checksum.")
    place, _ = found
    digest = _digest(path, place)
    with path.open("r+b") as file:
        file.seek(place)
        file.write(digest)


def check(path: Path) -> None:
    """Refuse a file that does not fit its checksum; one without any is of somebody else.

    Raises
    ------
    InputError
        If the file was changed after it was written.
    """
    try:
        found = _found(path)
        fits = found is None or found[1] == _digest(path, found[0])
    except OSError:
        return  # who reads it tells why it cannot be read
    if not fits:
        raise InputError(
            f"{path} was changed or damaged after it was written: its checksum does not fit.",
            remedy="Take it from a backup, or write it again; if it belongs to a run, delete its "
            "folder and run again.",
        )


@contextlib.contextmanager
def without_panics() -> Generator[None]:
    """Keep a panic of Rust from printing: its exception is told in a sentence of ours.

    Panics print to the descriptor of standard error, past Python. What anything else prints there
    meanwhile appears afterwards.
    """
    try:
        kept = os.dup(2)
    except OSError:  # closed: nothing is printed
        yield
        return
    with tempfile.TemporaryFile() as caught:
        os.dup2(caught.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            caught.seek(0)
            text = caught.read()
            if text and _PANIC not in text:
                with contextlib.suppress(OSError):
                    os.write(2, text)


def _found(path: Path) -> tuple[int, bytes] | None:
    """Return where the checksum stands and what it is; ``None`` where there is none."""
    size = path.stat().st_size
    with path.open("rb") as file:
        file.seek(max(0, size - 8))
        length = int.from_bytes(file.read(4), "little")
        start = max(0, size - 8 - min(length, _MOST_FOOTER))
        file.seek(start)
        matches = list(_STORED.finditer(file.read()))
    if len(matches) != 1:
        return None
    return start + matches[0].start(1), matches[0][1]


def _digest(path: Path, place: int) -> bytes:
    """Return the SHA-256 of a file with zeros in place of its checksum, as hexadecimal digits."""
    digest = hashlib.sha256()
    left = place
    with path.open("rb") as file:
        while left:
            piece = file.read(min(left, _PIECE))
            if not piece:
                break
            digest.update(piece)
            left -= len(piece)
        digest.update(_NOTHING.encode())
        file.seek(place + len(_NOTHING))
        while piece := file.read(_PIECE):
            digest.update(piece)
    return digest.hexdigest().encode()
