"""Runs stages one after the other in this process."""

from __future__ import annotations

import threading
from concurrent.futures import Future

from surmount.workflow.executor import Listener, StageResult, TellingMonitor
from surmount.workflow.stage_task import StageTask
from surmount.workflow.work import run_timed


class InProcessExecutor:
    """Runs each stage at once in this process, with one thread.

    Parameters
    ----------
    listener
        Told what stages tell.
    """

    slots = 1

    def __init__(self, listener: Listener) -> None:
        self._listener = listener
        self._stop = threading.Event()

    def submit(self, task: StageTask) -> Future[StageResult]:
        """Run the stage to its end."""
        future: Future[StageResult] = Future()
        monitor = TellingMonitor(task.name, self._listener, self._stop.is_set)
        try:
            future.set_result(run_timed(task, monitor))
        except Exception as error:  # noqa: BLE001 - handed on by the future
            future.set_exception(error)
        return future

    def poll(self, seconds: float) -> None:
        """Do nothing: everything was told while it ran."""

    def stop(self) -> None:
        """Let the running stage stop at its next opportunity."""
        self._stop.set()

    def close(self) -> None:
        """Do nothing: there are no workers."""
