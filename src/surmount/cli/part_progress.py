"""Progress of a verb that works in parts: a line that changes on a terminal, else a few lines."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Self, TextIO

from surmount.core.printing import escaped
from surmount.workflow.monitor import Progress, SilentMonitor

_INTERVAL_S = 0.1
_PLAIN_INTERVAL_S = 10.0


class PartProgress:
    """Says on standard error what is being done, and how far; the line goes when the block ends.

    Parameters
    ----------
    stream
        Where to say it; standard error where absent.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._alive = self._stream.isatty()
        self._told_at = float("-inf")
        self._part = ""

    def __enter__(self) -> Self:
        return self

    def __call__(self, part: str, done: int = 0, of: int | None = 1) -> None:
        """Say how far a part is, at once and then now and again; None is an end not known."""
        now = time.monotonic()
        interval = _INTERVAL_S if self._alive else _PLAIN_INTERVAL_S
        if part == self._part and now - self._told_at < interval:
            return
        self._part, self._told_at = part, now
        if of is None:
            count = f" {done:,}"
        else:
            count = f" {done} of {of}" if of > 1 and (done or self._alive) else ""
        text = escaped(part + count)
        self._stream.write(f"\r\x1b[2K{text} …" if self._alive else f"{text} …\n")
        self._stream.flush()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._alive and self._part:
            self._stream.write("\r\x1b[2K")
            self._stream.flush()


class PartMonitor(SilentMonitor):
    """Tells how far work is that asks for a monitor.

    Parameters
    ----------
    progress
        What says it.
    """

    def __init__(self, progress: PartProgress) -> None:
        self._progress = progress

    def progress(self, progress: Progress) -> None:
        """Say what is being done, and how much of it is."""
        self._progress(f"{progress.label}: {progress.unit}", progress.done, progress.planned)
