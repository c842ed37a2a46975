"""Standard streams that are not UTF-8, full or closed: borne, and told at the end."""

from __future__ import annotations

import io
import os
import sys
from typing import Any, TextIO

from surmount.core.errors import OutputError

_STDOUT, _STDERR = 1, 2


class BearingFile(io.FileIO):
    """A file whose refusals to take what is written are kept for the end.

    A run goes on where nobody can read its progress any more. A pipe whose reader has left is
    another matter: what writes to it may end.
    """

    failure: OSError | None = None

    def write(self, data: Any, /) -> int:
        """Write, or keep why that is not possible."""
        try:
            return super().write(data)
        except BrokenPipeError:
            raise
        except OSError as error:
            self.failure = error
            return memoryview(data).nbytes


def prepare() -> BearingFile | None:
    """Let standard output and error take any character and bear being full or closed.

    Returns
    -------
    BearingFile or None
        What standard output is written to; None where it is not the system's.
    """
    for number in (0, _STDOUT, _STDERR):
        try:
            os.fstat(number)
        except OSError:  # closed: or the next file that is opened would take its place
            os.open(os.devnull, os.O_RDWR)
    sys.stderr = _prepared(sys.stderr, _STDERR)[0]
    sys.stdout, file = _prepared(sys.stdout, _STDOUT)
    return file


def require_written(file: BearingFile | None) -> None:
    """Write what is left.

    Raises
    ------
    OutputError
        If standard output did not take everything.
    """
    sys.stdout.flush()
    if file is not None and file.failure is not None:
        raise OutputError(
            f"Standard output could not be written ({file.failure.strerror}).",
            remedy="Send it somewhere else; files that were to be written are there.",
        )


def _prepared(stream: TextIO | None, number: int) -> tuple[TextIO, BearingFile | None]:
    try:
        ours = stream is None or stream.fileno() == number
    except (OSError, ValueError):
        ours = False
    if stream is not None and not ours:
        return stream, None
    file = BearingFile(number, "w", closefd=False)
    made = io.TextIOWrapper(
        io.BufferedWriter(file),
        encoding=getattr(stream, "encoding", "utf-8"),
        errors="backslashreplace",
        line_buffering=number == _STDERR or file.isatty(),
    )
    return made, file
