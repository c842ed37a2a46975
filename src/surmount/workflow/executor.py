"""The one seam between an experiment and the machines it runs on.

An executor is given a stage whose inputs are finished, and answers with a future. It decides where
the stage runs, never what comes of it: every stage has one thread and its own seed, so that its
files have the same bytes wherever they were made.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Protocol

from surmount.core.errors import SurmountError
from surmount.workflow.monitor import Progress
from surmount.workflow.stage_task import StageTask
from surmount.workflow.store import Artefact

PROGRESS_INTERVAL_S = 0.2
"""A worker tells of its progress at most this often."""

RETRIES = 2
"""How often a stage is run again in the same call after its worker was lost."""


@dataclass(frozen=True, kw_only=True)
class StageEvent:
    """Something a running stage tells: its progress, or a sentence for the log."""

    stage: str
    told: Progress | str


Listener = Callable[[StageEvent], None]


@dataclass(frozen=True, kw_only=True)
class StageResult:
    """A finished stage.

    Attributes
    ----------
    artefact
        Its files; where the worker does not share the output folder, in the object store.
    seconds
        Time that the stage took, measured where it ran.
    """

    artefact: Artefact
    seconds: float


class WorkerLostError(SurmountError):
    """The worker of a stage was killed, or its machine was lost; the stage can be run again."""


class Executor(Protocol):
    """Runs stage tasks."""

    @property
    def slots(self) -> int:
        """How many stages may be submitted and unfinished at once."""
        ...

    def submit(self, task: StageTask) -> Future[StageResult]:
        """Start a stage; its future fails with :class:`WorkerLostError` if the worker is lost."""
        ...

    def poll(self, seconds: float) -> None:
        """Pass on what stages tell, for at most so long, or until one has ended."""
        ...

    def stop(self) -> None:
        """Ask all running stages to save themselves and stop; may be called by a signal handler."""
        ...

    def close(self) -> None:
        """Release workers."""
        ...


class TellingMonitor:
    """Passes on progress, at most every :data:`PROGRESS_INTERVAL_S`, and sentences.

    Parameters
    ----------
    stage
        Name of the stage.
    listener
        Told everything.
    stopped
        Says whether the stage should stop.
    """

    def __init__(self, stage: str, listener: Listener, stopped: Callable[[], bool]) -> None:
        self._stage = stage
        self._listener = listener
        self._stopped = stopped
        self._told_at = float("-inf")

    def progress(self, progress: Progress) -> None:
        """Pass on progress."""
        now = time.monotonic()
        if now - self._told_at >= PROGRESS_INTERVAL_S:
            self._told_at = now
            self._listener(StageEvent(stage=self._stage, told=progress))

    def log(self, sentence: str) -> None:
        """Pass on a sentence."""
        self._listener(StageEvent(stage=self._stage, told=sentence))

    def should_stop(self) -> bool:
        """Whether the executor was asked to stop."""
        return self._stopped()
