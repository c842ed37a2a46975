"""What an analysis tells while it works: which part it is in, and how far."""

from __future__ import annotations

import threading
from collections.abc import Callable

Progress = Callable[[str, int, int], None]
"""Told the part, what is done of it, and of how many; from one thread at a time."""


def silent(_part: str, _done: int, _of: int) -> None:
    """Tell nothing."""


def counter(progress: Progress, part: str, total: int) -> Callable[[], None]:
    """Return what is to be called after each piece of a part, from any thread."""
    lock = threading.Lock()
    done = 0

    def advance() -> None:
        nonlocal done
        with lock:
            done += 1
            progress(part, done, total)

    progress(part, 0, total)
    return advance
