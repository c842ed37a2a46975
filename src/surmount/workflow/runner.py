"""Runs a graph of stages: what is missing and nothing else, several at a time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from surmount.workflow.artefact_store import ArtefactStore
from surmount.workflow.executor import RETRIES, Executor, StageResult, WorkerLostError
from surmount.workflow.folder_guard import FolderGuard
from surmount.workflow.graph import Stage, check_graph, dependencies
from surmount.workflow.monitor import Interrupted
from surmount.workflow.stage_task import StageTask
from surmount.workflow.store import Artefact

POLL_S = 0.1


class RunObserver(Protocol):
    """Watches a run: for a progress display or a log file."""

    def stage_reused(self, artefact: Artefact) -> None:
        """Take note that a stage was finished by an earlier call."""
        ...

    def stage_outdated(self, stage: str, folders: Sequence[Path]) -> None:
        """Take note that a stage was finished, but not from what it is made from now."""
        ...

    def stage_started(self, stage: str) -> None:
        """Take note that a stage has begun."""
        ...

    def stage_finished(self, artefact: Artefact, seconds: float) -> None:
        """Take note that a stage was finished now."""
        ...

    def stage_lost(self, stage: str, *, again: bool) -> None:
        """Take note that a stage's worker was lost, and whether the stage is run again."""
        ...


@dataclass(frozen=True, kw_only=True)
class RunOutcome:
    """What a run left.

    Attributes
    ----------
    artefacts
        Every finished stage by name.
    interrupted
        Whether the run was asked to stop before it was complete.
    """

    artefacts: dict[str, Artefact]
    interrupted: bool


class GraphRunner:
    """Runs the stages of one graph through an executor.

    Parameters
    ----------
    root
        The output folder.
    stages
        The graph. Of stages that could start, the first in this order does.
    executor
        Where stages run.
    observer
        Watches.
    depot
        Where finished stages are looked for and kept; the output folder alone if not given.
    retries
        How often a stage is run again after its worker was lost.
    """

    def __init__(
        self,
        root: Path,
        stages: Iterable[Stage],
        executor: Executor,
        observer: RunObserver,
        *,
        depot: ArtefactStore | None = None,
        retries: int = RETRIES,
    ) -> None:
        self._depot = depot or ArtefactStore(root=root)
        self._retries = retries
        self._lost: Counter[str] = Counter()
        self._waiting = check_graph(stages := tuple(stages))
        self._places = {stage.name: place for place, stage in enumerate(stages)}
        self._executor = executor
        self._observer = observer
        self._finished: dict[str, Artefact] = {}
        self._running: dict[str, tuple[Stage, Future[StageResult]]] = {}
        self._missing: dict[str, str] = {}
        self._guard = FolderGuard(self._depot.root)
        self._stopping = False
        self._interrupted = False

    def stop(self) -> None:
        """Let running stages save themselves, and start no more."""
        self._stopping = True
        self._executor.stop()

    def run(self) -> RunOutcome:
        """Run until the graph is finished or the run is stopped.

        What was finished before is verified, and what no longer fits is told, before anything is
        started.

        Raises
        ------
        SurmountError
            What the first failing stage found wrong, after the others have saved themselves.
        IntegrityError
            If a stage that was finished before was changed since.
        OutputError
            If the output folder, or what was finished in it, was removed meanwhile.
        """
        with self._guard:
            return self._run()

    def _run(self) -> RunOutcome:
        failure: Exception | None = None
        while self._waiting or self._running:
            if not self._stopping:
                self._keep_finished()
                self._start_ready()
            if not self._running:
                if self._stopping:
                    break
                continue
            self._executor.poll(POLL_S)
            failure = self._take_finished() or failure
            if failure is not None and not self._stopping:
                self.stop()
        if failure is not None:
            raise failure
        return RunOutcome(
            artefacts=dict(self._finished),
            interrupted=self._interrupted or bool(self._waiting),
        )

    def _keep_finished(self) -> None:
        """Keep what is finished already; the graph's order lets one pass reach all of it."""
        for name, stage in list(self._waiting.items()):
            if name in self._missing or not dependencies(stage) <= self._finished.keys():
                continue
            key = stage.key(self._finished)
            found = self._find(stage, key)
            if found is None:
                self._missing[name] = key
                outdated = self._depot.store.others(name, key)
                if outdated:
                    self._observer.stage_outdated(name, outdated)
                continue
            found.verify()
            del self._waiting[name]
            self._finished[name] = found
            self._observer.stage_reused(found)

    def _start_ready(self) -> None:
        for name in sorted(self._missing, key=self._places.__getitem__):
            if len(self._running) >= self._executor.slots or self._stopping:
                return
            key = self._missing.pop(name)
            stage = self._waiting.pop(name)
            self._observer.stage_started(name)
            self._running[name] = (stage, self._executor.submit(self._task(stage, key)))

    def _find(self, stage: Stage, key: str) -> Artefact | None:
        """Return a stage that is finished, also under the key of earlier versions.

        Where it is not finished, a checkpoint under that key becomes the stage's.
        """
        found = self._depot.find(stage.name, key)
        legacy = stage.legacy_key(self._finished)
        if found is not None or legacy is None:
            return found
        found = self._depot.find(stage.name, legacy)
        if found is None:
            self._depot.store.adopt_checkpoint(stage.name, legacy, key)
        return found

    def _task(self, stage: Stage, key: str) -> StageTask:
        return StageTask(
            depot=self._depot,
            name=stage.name,
            key=key,
            function=stage.kind.function,
            config=stage.config,
            seed=stage.seed,
            resources=stage.resources,
            inputs={
                role: tuple(self._finished[name] for name in names)
                for role, names in stage.inputs.items()
            },
        )

    def _take_finished(self) -> Exception | None:
        """Take the stages that have ended, and return the first failure among them."""
        failure: Exception | None = None
        for name, (stage, future) in list(self._running.items()):
            if not future.done():
                continue
            del self._running[name]
            error = future.exception()
            if error is None:
                self._finish(future.result())
            elif isinstance(error, Interrupted):
                self._interrupted = True
                self._stopping = True
            elif isinstance(error, WorkerLostError):
                self._lost[name] += 1
                again = self._stopping or self._lost[name] <= self._retries
                self._observer.stage_lost(name, again=again)
                if again:
                    self._waiting[name] = stage  # goes on from its last checkpoint
                else:
                    failure = failure or error
            else:
                failure = failure or _as_exception(error)
        return failure

    def _finish(self, result: StageResult) -> None:
        self._guard.check(self._finished.values())
        artefact = self._depot.bring(result.artefact)
        self._finished[artefact.stage] = artefact
        self._observer.stage_finished(artefact, result.seconds)


def _as_exception(error: BaseException) -> Exception:
    return error if isinstance(error, Exception) else RuntimeError(str(error))
