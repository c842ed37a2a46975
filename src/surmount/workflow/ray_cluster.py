"""Runs stages on a Ray cluster, or on a Ray started on this machine.

Ray decides where and when: every stage whose inputs are finished is handed to it with what it
takes of a machine. Ray does not run a stage again by itself; the runner does, and counts.
"""

from __future__ import annotations

import contextlib
import logging
import os
import pickle
import sys
import tempfile
import threading
import time
from concurrent.futures import FIRST_COMPLETED, Future, wait
from pathlib import Path
from typing import Any, cast

import ray
from ray.exceptions import RayError

from surmount.core.errors import OutputError, SurmountError
from surmount.workflow.executor import (
    Listener,
    StageEvent,
    StageResult,
    TellingMonitor,
    WorkerLostError,
)
from surmount.workflow.run_layout import RUN
from surmount.workflow.stage_task import StageTask
from surmount.workflow.work import run_timed

EXCHANGE_S = 0.5
"""How often a worker delivers its events and asks whether to stop."""
CLOSE_S = 10.0
"""How long closing waits for stages that have been asked to stop."""
BYTES_PER_MB = 1_000_000


class RayExecutor:
    """Hands stages to Ray.

    Parameters
    ----------
    listener
        Told what stages tell, in the process of the caller.
    address
        Of the head, ``"host:port"`` or ``"auto"``; Ray is started here, and ended, if ``None``.
    processes
        Cores for a Ray started here; all if ``None``. A cluster brings its own.

    Raises
    ------
    SurmountError
        If the head cannot be reached.
    """

    slots = sys.maxsize
    """Ray queues what it cannot run yet."""

    def __init__(
        self, listener: Listener, *, address: str | None = None, processes: int | None = None
    ) -> None:
        self._listener = listener
        self._stopping = False
        self._told = False
        self._running: dict[Future[Any], Any] = {}
        os.environ.setdefault("RAY_worker_niceness", "0")  # for a Ray started here; 15 otherwise
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # nothing is sent anywhere
        try:
            ray.init(
                address=address or "local",
                num_cpus=None if address else processes,
                include_dashboard=None if address else False,
                log_to_driver=False,
                logging_level=logging.ERROR,
                namespace="surmount",
            )
        except (ConnectionError, RuntimeError, ValueError, RayError) as error:
            raise SurmountError(
                f"Ray at {address or 'this machine'} cannot be used ({_first_line(error)}).",
                remedy="Give the --address that `ray start --head` printed, with the same versions "
                "of Python and Ray there as here.",
            ) from error
        self._mailbox: Any = _mailbox_class().remote()

    def submit(self, task: StageTask) -> Future[StageResult]:
        """Hand the stage to Ray."""
        outcome: Future[StageResult] = Future()
        work: Any = ray.remote(_work).options(
            num_cpus=task.resources.cpus,
            memory=task.resources.memory_mb * BYTES_PER_MB,
            max_retries=0,
            name=task.name,
        )
        reference = work.remote(task, self._mailbox)
        inner = cast("Future[Any]", reference.future())
        self._running[inner] = reference

        def pass_on(done: Future[Any]) -> None:
            error = done.exception()
            if error is not None:
                lost = WorkerLostError(
                    f"The Ray worker of stage `{task.name}` was lost ({_first_line(error)}).",
                    remedy="Run the same command again: it goes on from the last checkpoint. If "
                    "memory ran out, give the cluster's nodes fewer CPUs.",
                )
                outcome.set_exception(lost)
            elif isinstance(done.result(), Exception):
                outcome.set_exception(done.result())
            else:
                outcome.set_result(done.result())

        inner.add_done_callback(pass_on)
        return outcome

    def poll(self, seconds: float) -> None:
        """Pass on what the workers tell, for at most so long, or until a stage has ended."""
        if self._stopping and not self._told:
            self._told = True
            self._mailbox.stop.remote()
        running = [future for future in self._running if not future.done()]
        if running:
            wait(running, timeout=seconds, return_when=FIRST_COMPLETED)
        self._running = {f: reference for f, reference in self._running.items() if not f.done()}
        with contextlib.suppress(RayError):  # the mailbox begins anew where its node was lost
            for letter in ray.get(self._mailbox.take.remote(), timeout=CLOSE_S):
                for event in pickle.loads(letter):  # noqa: S301 - of our own workers
                    self._listener(event)

    def stop(self) -> None:
        """Let running stages stop at their next opportunity."""
        self._stopping = True  # passed on by `poll`: a signal may arrive within a call to Ray

    def close(self) -> None:
        """Leave the cluster, or end the Ray that was started here."""
        self.stop()
        deadline = time.monotonic() + CLOSE_S
        while self._running and time.monotonic() < deadline:
            self.poll(EXCHANGE_S)
        ray.shutdown()


def _mailbox_class() -> Any:
    """Return the actor that keeps what workers tell until it is fetched.

    It is defined here and handles packed events, so that its process need not import the
    laboratory: it is ready in a second.
    """

    class Mailbox:
        def __init__(self) -> None:
            self._letters: list[bytes] = []
            self._stopped = False

        def exchange(self, letter: bytes | None) -> bool:
            if letter is not None:
                self._letters.append(letter)
            return self._stopped

        def take(self) -> list[bytes]:
            letters, self._letters = self._letters, []
            return letters

        def stop(self) -> None:
            self._stopped = True

    return cast("Any", ray.remote(Mailbox)).options(
        num_cpus=0, max_restarts=-1, max_task_retries=-1
    )


class _Post:
    """Delivers a worker's events, and learns whether it should stop, now and then."""

    def __init__(self, mailbox: Any) -> None:
        self._mailbox = mailbox
        self._events: list[StageEvent] = []
        self._lock = threading.Lock()
        self._stopped = threading.Event()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._deliver_regularly, daemon=True)
        self._thread.start()

    def put(self, event: StageEvent) -> None:
        with self._lock:
            self._events.append(event)

    def stopped(self) -> bool:
        return self._stopped.is_set()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()
        self._deliver()

    def _deliver_regularly(self) -> None:
        while not self._ended.is_set():
            self._deliver()
            self._ended.wait(EXCHANGE_S)

    def _deliver(self) -> None:
        with self._lock:
            events, self._events = self._events, []
        letter = pickle.dumps(events) if events else None
        with contextlib.suppress(RayError):  # what was told is lost, the work is not
            if ray.get(self._mailbox.exchange.remote(letter)):
                self._stopped.set()


def _work(task: StageTask, mailbox: Any) -> StageResult | Exception:
    """Run a stage on a worker; what it finds wrong is returned, what kills it is Ray's to tell."""
    post = _Post(mailbox)
    monitor = TellingMonitor(task.name, post.put, post.stopped)
    try:
        if task.depot.url is None:
            _require_shared(task.depot.root)
            return run_timed(task, monitor)
        with tempfile.TemporaryDirectory(prefix="surmount-") as folder:
            here = task.depot.elsewhere(Path(folder))
            return run_timed(task.at(here), monitor)
    except Exception as error:  # noqa: BLE001 - raised where the run was begun
        return error
    finally:
        post.close()


def _require_shared(root: Path) -> None:
    if not (root / ".lock").is_file() and not (root / RUN).is_file():
        raise OutputError(
            f"A worker does not see the output folder {root}.",
            remedy="Give an --out folder on a file system that all nodes share under one path, or "
            "an object store by --store.",
        )


def _first_line(error: BaseException) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0]
