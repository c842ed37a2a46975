"""Ctrl-C while modules are imported: ends at once, because an import bears no interruption."""

from __future__ import annotations

import os
import signal
import threading
from types import FrameType

INTERRUPTED = 130
"""Exit code of a process that was interrupted."""
_IMPORTING = "<frozen importlib"
_MESSAGE = b"surmount: interrupted.\n"


def prepare() -> None:
    """Take Ctrl-C from now on, unless somebody else does."""
    if threading.current_thread() is not threading.main_thread():  # only it may handle signals
        return
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _handle)


def _handle(_number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, or end where a module is being imported.

    Modules in C turn an exception within their import into one of their own, or end the process.
    Nothing is half-written then: files appear by a rename.
    """
    while frame is not None:
        if frame.f_code.co_filename.startswith(_IMPORTING):
            os.write(2, _MESSAGE)
            os._exit(INTERRUPTED)
        frame = frame.f_back
    raise KeyboardInterrupt
