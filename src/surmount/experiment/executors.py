"""Where stages run: in this process, or in several single-threaded local processes.

Independent runs in separate single-threaded processes beat threading one run, and one thread per
stage makes results independent of the number of cores.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import queue
import signal
import threading
import time
from collections.abc import Callable, Generator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing.queues import Queue
from multiprocessing.synchronize import Event as StopEvent
from typing import Protocol

import torch
from threadpoolctl import threadpool_limits

from surmount.core.errors import ConfigError, SurmountError
from surmount.core.monitor import Progress
from surmount.core.store import Artefact
from surmount.experiment.task import StageTask, execute

PROGRESS_INTERVAL_S = 0.2
"""A worker tells of its progress at most this often."""
WATCH_INTERVAL_S = 0.5
"""How often a worker looks whether the process that started it still lives."""
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True, kw_only=True)
class StageEvent:
    """Something a running stage tells: its progress, or a sentence for the log."""

    stage: str
    told: Progress | str


Listener = Callable[[StageEvent], None]


class Executor(Protocol):
    """Runs stage tasks. The one seam between the experiment and the machines it runs on."""

    @property
    def slots(self) -> int:
        """How many stages run at once."""
        ...

    def submit(self, task: StageTask) -> Future[Artefact]:
        """Start a stage."""
        ...

    def poll(self, seconds: float) -> None:
        """Pass on what stages tell, for at most so long."""
        ...

    def stop(self) -> None:
        """Ask all running stages to save themselves and stop."""
        ...

    def close(self) -> None:
        """Release workers."""
        ...


class InProcessExecutor:
    """Runs each stage at once in this process, with one thread."""

    slots = 1

    def __init__(self, listener: Listener) -> None:
        self._listener = listener
        self._stop = threading.Event()

    def submit(self, task: StageTask) -> Future[Artefact]:
        """Run the stage to its end."""
        future: Future[Artefact] = Future()
        torch.set_num_threads(1)
        monitor = _TellingMonitor(task.name, self._listener, self._stop.is_set)
        try:
            with threadpool_limits(1):
                future.set_result(execute(task, monitor))
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


class ProcessExecutor:
    """Runs stages in worker processes of one thread each.

    Parameters
    ----------
    processes
        Number of workers.
    listener
        Told what stages tell, in the process of the caller.
    """

    def __init__(self, processes: int, listener: Listener) -> None:
        if processes < 1:
            raise ConfigError(
                f"{processes} worker processes cannot run anything.", remedy="Give at least one."
            )
        self._slots = processes
        self._listener = listener
        spawn = multiprocessing.get_context("spawn")
        self._events: Queue[StageEvent] = spawn.Queue()
        self._stop: StopEvent = spawn.Event()
        with _one_thread_for_children():
            self._pool = ProcessPoolExecutor(
                processes,
                mp_context=spawn,
                initializer=_begin_worker,
                initargs=(self._events, self._stop, os.getpid()),
            )
            # Workers are spawned by the first tasks; each inherits the variables set here.
            try:
                for future in [self._pool.submit(os.getpid) for _ in range(processes)]:
                    future.result()
            except BrokenProcessPool as error:
                raise SurmountError(
                    "The worker processes ended as soon as they were started.",
                    remedy="In a script of your own, call Surmount below "
                    "`if __name__ == '__main__':`; if memory ran out, use fewer processes.",
                ) from error

    @property
    def slots(self) -> int:
        """Number of workers."""
        return self._slots

    def submit(self, task: StageTask) -> Future[Artefact]:
        """Start the stage in a free worker."""
        return self._pool.submit(_execute_in_worker, task)

    def poll(self, seconds: float) -> None:
        """Pass on what the workers tell, for at most so long."""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            try:
                self._listener(self._events.get(timeout=left))
            except queue.Empty:
                return

    def stop(self) -> None:
        """Let running stages stop at their next opportunity."""
        self._stop.set()

    def close(self) -> None:
        """End the workers."""
        self._pool.shutdown(wait=True, cancel_futures=True)
        self.poll(0.01)


BrokenExecutor = BrokenProcessPool
"""Raised by futures when a worker was killed."""


class _TellingMonitor:
    """Passes on progress, at most every :data:`PROGRESS_INTERVAL_S`, and sentences."""

    def __init__(self, stage: str, listener: Listener, stopped: Callable[[], bool]) -> None:
        self._stage = stage
        self._listener = listener
        self._stopped = stopped
        self._told_at = float("-inf")

    def progress(self, progress: Progress) -> None:
        now = time.monotonic()
        if now - self._told_at >= PROGRESS_INTERVAL_S:
            self._told_at = now
            self._listener(StageEvent(stage=self._stage, told=progress))

    def log(self, sentence: str) -> None:
        self._listener(StageEvent(stage=self._stage, told=sentence))

    def should_stop(self) -> bool:
        return self._stopped()


_worker: tuple[Queue[StageEvent], StopEvent] | None = None


def _begin_worker(events: Queue[StageEvent], stop: StopEvent, parent: int) -> None:
    """Prepare a worker: one thread, deaf to Ctrl-C, and not outliving its parent."""
    global _worker  # noqa: PLW0603 - one per worker process, set once when it begins
    _worker = (events, stop)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides, through `stop`
    torch.set_num_threads(1)
    threading.Thread(target=_die_with, args=(parent,), daemon=True).start()


def _die_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(WATCH_INTERVAL_S)
    os._exit(1)  # artefacts and checkpoints appear by a rename: nothing is left half-written


def _execute_in_worker(task: StageTask) -> Artefact:
    if _worker is None:
        raise RuntimeError("The worker process was not prepared.")
    events, stop = _worker
    return execute(task, _TellingMonitor(task.name, events.put, stop.is_set))


@contextlib.contextmanager
def _one_thread_for_children() -> Generator[None]:
    before = {name: os.environ.get(name) for name in THREAD_VARIABLES}
    os.environ.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
