"""Runs stages in local worker processes of one thread each.

Independent runs in separate single-threaded processes beat threading one run. Each worker is a pool
of one process: when it is killed, that concerns its own stage and no other. A worker tells its
events through a pipe that only it writes to, so that one that dies blocks nobody.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import signal
import threading
import time
from collections.abc import Generator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.connection import Connection, wait
from typing import Any, TypeAlias

import torch

from surmount.core.errors import ConfigError, SurmountError
from surmount.workflow.executor import (
    Listener,
    StageEvent,
    StageResult,
    TellingMonitor,
    WorkerLostError,
)
from surmount.workflow.stage_task import StageTask
from surmount.workflow.work import run_timed

WATCH_INTERVAL_S = 0.5
"""How often a worker looks whether the process that started it still lives."""
SLICE_S = 0.02
"""While waiting, finished stages are looked for this often."""
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_STOP = "stop"

Pipe: TypeAlias = "Connection[Any, Any]"


class ProcessExecutor:
    """Runs stages in worker processes of one thread each, started as they are needed.

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
        self._workers: list[_Worker] = [_Worker()]

    @property
    def slots(self) -> int:
        """Number of workers."""
        return self._slots

    def submit(self, task: StageTask) -> Future[StageResult]:
        """Start the stage in a free worker."""
        self._drop_dead()
        worker = next((worker for worker in self._workers if worker.is_free), None)
        if worker is None:
            worker = _Worker()
            self._workers.append(worker)
        return worker.begin(task)

    def poll(self, seconds: float) -> None:
        """Pass on what the workers tell, for at most so long, or until a stage has ended."""
        deadline = time.monotonic() + seconds
        busy = [worker for worker in self._workers if not worker.is_free]
        while (left := deadline - time.monotonic()) > 0:
            self._take(min(left, SLICE_S))
            if any(worker.is_free for worker in busy):
                self._take(0.0)  # the last words of the stage that has ended
                return

    def stop(self) -> None:
        """Let running stages stop at their next opportunity."""
        for worker in self._workers:
            worker.stop()

    def close(self) -> None:
        """End the workers, after running stages have saved themselves."""
        self.stop()
        while not all(worker.is_free for worker in self._workers):
            self.poll(SLICE_S)
        self._take(0.0)
        for worker in self._workers:
            worker.close()

    def _take(self, seconds: float) -> None:
        """Pass on events, waiting at most so long for the first."""
        while pipes := [worker.pipe for worker in self._workers if worker.is_open]:
            ready = wait(pipes, seconds)
            if not ready:
                return
            for worker in self._workers:
                event = worker.receive() if worker.pipe in ready else None
                if event is not None:
                    self._listener(event)
            seconds = 0.0

    def _drop_dead(self) -> None:
        for worker in [worker for worker in self._workers if worker.is_lost]:
            worker.close()
            self._workers.remove(worker)


class _Worker:
    """One worker process, seen from the process that started it."""

    def __init__(self) -> None:
        spawn = multiprocessing.get_context("spawn")
        pipes: tuple[Any, Any] = spawn.Pipe()
        self.pipe: Pipe = pipes[0]
        theirs: Pipe = pipes[1]
        self.is_open = True
        self.is_lost = False
        self._future: Future[StageResult] | None = None
        self._pool = ProcessPoolExecutor(
            1,
            mp_context=spawn,
            initializer=_begin_worker,
            initargs=(theirs, os.getpid()),
        )
        try:
            with _inherited_by_children():  # the process is spawned here
                ready = self._pool.submit(os.getpid)
            ready.result()
        except BrokenProcessPool as error:
            raise SurmountError(
                "The worker processes ended as soon as they were started.",
                remedy="In a script of your own, call Surmount below "
                "`if __name__ == '__main__':`; if memory ran out, use fewer processes.",
            ) from error
        finally:
            theirs.close()  # the worker's copy is the only one: the pipe ends when it dies

    @property
    def is_free(self) -> bool:
        return self._future is None or self._future.done()

    def begin(self, task: StageTask) -> Future[StageResult]:
        outcome: Future[StageResult] = Future()
        self._future = outcome
        try:
            inner = self._pool.submit(_execute_in_worker, task)
        except BrokenProcessPool as error:  # killed while it had nothing to do
            self._lose(task, outcome, error)
            return outcome

        def pass_on(done: Future[StageResult]) -> None:
            error = done.exception()
            if error is None:
                outcome.set_result(done.result())
            elif isinstance(error, BrokenProcessPool):
                self._lose(task, outcome, error)
            else:
                outcome.set_exception(error)

        inner.add_done_callback(pass_on)
        return outcome

    def _lose(self, task: StageTask, outcome: Future[StageResult], cause: Exception) -> None:
        self.is_lost = True
        error = WorkerLostError(
            f"The worker process of stage `{task.name}` was killed.",
            remedy="Run the same command again: it goes on from the last checkpoint. If memory "
            "ran out, use fewer processes.",
        )
        error.__cause__ = cause
        outcome.set_exception(error)

    def receive(self) -> StageEvent | None:
        """Return the next event; the pipe is closed where the worker died, or died writing."""
        try:
            event: Any = self.pipe.recv()
        except (EOFError, OSError, pickle.UnpicklingError):
            self.is_open = False
            return None
        return event

    def stop(self) -> None:
        with contextlib.suppress(OSError):  # a worker that has gone need not stop
            self.pipe.send(_STOP)

    def close(self) -> None:
        self._pool.shutdown(wait=True, cancel_futures=True)


class _Parent:
    """The process that started this worker, seen from here."""

    def __init__(self, pipe: Pipe) -> None:
        self._pipe = pipe
        self._stopped = False

    def tell(self, event: StageEvent) -> None:
        with contextlib.suppress(OSError):  # it has gone, and this process will follow
            self._pipe.send(event)

    def asks_to_stop(self) -> bool:
        with contextlib.suppress(OSError, EOFError):
            self._stopped = self._stopped or (self._pipe.poll() and self._pipe.recv() == _STOP)
        return self._stopped


_parent: _Parent | None = None


def _begin_worker(pipe: Pipe, parent: int) -> None:
    """Prepare a worker: one thread, deaf to Ctrl-C, and not outliving its parent."""
    global _parent  # noqa: PLW0603 - one per worker process, set once when it begins
    _parent = _Parent(pipe)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides, through the pipe
    torch.set_num_threads(1)
    threading.Thread(target=_die_with, args=(parent,), daemon=True).start()


def _die_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(WATCH_INTERVAL_S)
    os._exit(1)  # artefacts and checkpoints appear by a rename: nothing is left half-written


def _execute_in_worker(task: StageTask) -> StageResult:
    if _parent is None:
        raise RuntimeError("The worker process was not prepared.")
    return run_timed(task, TellingMonitor(task.name, _parent.tell, _parent.asks_to_stop))


@contextlib.contextmanager
def _inherited_by_children() -> Generator[None]:
    """Let processes that are started here have one thread, and be deaf to Ctrl-C from the first.

    A signal that is blocked stays so in a new program; this process gets it when the block ends.
    """
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    before = {name: os.environ.get(name) for name in THREAD_VARIABLES}
    os.environ.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
