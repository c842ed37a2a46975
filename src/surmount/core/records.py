"""JSON records on disk: one canonical text per record, written whole or not at all."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from surmount.core.errors import InputError


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
        If the file is missing, is not JSON, or does not hold an object.
    """
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path} cannot be read ({error}).", remedy="Give the path of a readable JSON file."
        ) from error
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{path} is not valid JSON ({error}).", remedy="Correct it at the place named."
        ) from error
    if not isinstance(record, dict):
        raise InputError(
            f"{path} holds {type(record).__name__}, not a JSON object.",
            remedy="Give a file that Surmount wrote.",
        )
    return cast(dict[str, Any], record)


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that a reader sees the old content or the new one, never a part."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        with temporary.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
