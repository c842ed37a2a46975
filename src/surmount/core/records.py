"""JSON records on disk: one canonical text per record, written whole or not at all."""

from __future__ import annotations

import hashlib
import json
import math
import os
import secrets
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, cast

from surmount.core.errors import InputError, IntegrityError

SEAL = "record_sha256"
"""Key of a record's hash of itself: over its canonical text without this key."""
_MOST_DIGITS = 300
"""Digits of a whole number; more are beyond what a float can hold."""


def canonical_json(record: object) -> str:
    """Return the one text of a record used for hashing: sorted keys, no spaces, no NaN."""
    return json.dumps(record, sort_keys=True, separators=(",", ":"), allow_nan=False)


def record_hash(record: object) -> str:
    """Return the SHA-256 of a record's canonical text, in hexadecimal."""
    return hashlib.sha256(canonical_json(record).encode()).hexdigest()


def file_hash(path: Path) -> str:
    """Return the SHA-256 of a file's content, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_record(path: Path, record: Mapping[str, Any]) -> None:
    """Write a record as indented JSON, atomically.

    Raises
    ------
    ValueError
        If the record holds NaN or infinity: these are errors of ours, not results.
    """
    text = json.dumps(record, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    write_atomically(path, text.encode())


def read_record(path: Path) -> dict[str, Any]:
    """Read a JSON object.

    Raises
    ------
    InputError
        If the file is missing, is not a plain file, is not JSON, or does not hold an object.
    """
    try:
        content = read_bytes(path)
    except (OSError, ValueError) as error:
        raise InputError(
            f"{path} cannot be read ({error}).", remedy="Give the path of a readable JSON file."
        ) from error
    return parse_record(content, str(path))


def sealed(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return a record with a hash of itself, in place of an earlier one."""
    bare = {key: value for key, value in record.items() if key != SEAL}
    return {**bare, SEAL: record_hash(bare)}


def read_sealed(path: Path, keys: Collection[str], *, remedy: str) -> dict[str, Any]:
    """Read a record that :func:`sealed` gave a hash, or one of before there were hashes.

    Parameters
    ----------
    path
        The file.
    keys
        What such a record may hold; a record without a hash that holds anything else once had one.
    remedy
        What to do about a damaged file.

    Returns
    -------
    dict
        The record without its hash.

    Raises
    ------
    IntegrityError
        If the file cannot be read, or does not fit its hash.
    """
    try:
        content = read_bytes(path)
    except (OSError, ValueError) as error:
        raise IntegrityError(f"{path} cannot be read ({error}).", remedy=remedy) from error
    return parse_sealed(content, str(path), keys, remedy=remedy)


def parse_sealed(
    content: bytes, source: str, keys: Collection[str], *, remedy: str
) -> dict[str, Any]:
    """Read a sealed record from a file's content; see :func:`read_sealed`.

    Raises
    ------
    IntegrityError
        If the content is no record, or does not fit its hash.
    """
    try:
        record = parse_record(content, source)
    except InputError as error:
        what = f"{source} was truncated or damaged: {error.message.removeprefix(source).lstrip()}"
        raise IntegrityError(what, remedy=remedy) from error
    seal = record.pop(SEAL, None)
    fits = set(record) <= set(keys) if seal is None else seal == record_hash(record)
    if not fits:
        raise IntegrityError(
            f"{source} was changed or damaged after it was written: its hash does not fit.",
            remedy=remedy,
        )
    return record


def read_bytes(path: Path) -> bytes:
    """Return a file's content.

    Raises
    ------
    OSError
        If it cannot be read, or is a pipe or a device, which would never end.
    """
    if path.exists() and not path.is_file():
        raise OSError("it is not a file")
    return path.read_bytes()


def parse_record(content: bytes, source: str) -> dict[str, Any]:
    """Read a JSON object from a file's content.

    Parameters
    ----------
    content
        UTF-8 text, with or without mark.
    source
        How errors name it.

    Raises
    ------
    InputError
        If it is not JSON, holds a number beyond a float's range or a key twice, or does not hold an
        object.
    """
    try:
        record = parse_json(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise InputError(
            f"{source} cannot be read ({error}).", remedy="Give the path of a readable JSON file."
        ) from error
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{source} is not valid JSON ({error}).", remedy="Correct it at the place named."
        ) from error
    if not isinstance(record, dict):
        raise InputError(
            f"{source} holds {type(record).__name__}, not a JSON object.",
            remedy="Give a file that Surmount wrote.",
        )
    return cast(dict[str, Any], record)


def parse_json(text: str) -> Any:
    """Read JSON of which every reader makes the same: no key twice, every number a finite float.

    Raises
    ------
    ValueError, RecursionError
        If it is not such JSON.
    """
    return json.loads(
        text,
        parse_constant=_refuse_constant,
        parse_float=_finite,
        parse_int=_whole,
        object_pairs_hook=_without_doubles,
    )


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is not a number in JSON")


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text[:40]} is beyond the range of numbers")
    return value


def _whole(text: str) -> int:
    if len(text) > _MOST_DIGITS:
        raise ValueError(f"a number of {len(text):,} digits is beyond the range of numbers")
    return int(text)


def _without_doubles(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    record = dict(pairs)
    if len(record) < len(pairs):
        seen: set[str] = set()
        double = next(key for key, _ in pairs if key in seen or seen.add(key))
        raise ValueError(f"the key {double[:40]!r} stands there twice")
    return record


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that a reader sees the old content or the new one, never a part.

    The name of the temporary file cannot be guessed, and nothing may have it: a link planted under
    that name is not followed.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        with temporary.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
    synchronise(path.parent)


def synchronise(path: Path) -> None:
    """Let a file's content, or a folder's names, outlast a loss of power."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
