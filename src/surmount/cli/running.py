"""Running graphs of stages with progress: an experiment, or maps over many settings."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

from rich.console import Console

from surmount.cli.display import RunDisplay
from surmount.cli.main import INTERRUPTED
from surmount.cli.workers import Workers
from surmount.experiment.config import ExperimentConfig, fingerprinted
from surmount.experiment.running import begin, refuse_other, run
from surmount.workflow.artefact_store import ArtefactStore
from surmount.workflow.executor import Executor
from surmount.workflow.graph import Stage
from surmount.workflow.runner import GraphRunner, RunOutcome
from surmount.workflow.store import output_errors, sole_user


def run_experiment(
    out: Path,
    config: ExperimentConfig,
    graph: Callable[[ExperimentConfig], list[Stage]],
    workers: Workers,
    console: Console,
) -> RunOutcome:
    """Begin an experiment in a folder, or go on with the one there, and run its stages."""
    workers.check()
    config = fingerprinted(config)
    stages = graph(config)
    refuse_other(out, config)
    with sole_user(out):
        begin(out, config)
        with _progress(out, workers, console) as (executor, display, on_ready):
            return run(
                out,
                config,
                executor,
                display,
                on_ready=on_ready,
                stages=stages,
                url=workers.store,
                retries=workers.retries,
            )


def run_graph(out: Path, graph: list[Stage], workers: Workers, console: Console) -> RunOutcome:
    """Run stages into a folder with progress, stopping cleanly at Ctrl-C."""
    with _progress(out, workers, console) as (executor, display, on_ready), output_errors(out):
        depot = ArtefactStore(root=out, url=workers.store)
        runner = GraphRunner(out, graph, executor, display, depot=depot, retries=workers.retries)
        on_ready(runner)
        return runner.run()


@contextmanager
def _progress(
    out: Path, workers: Workers, console: Console
) -> Generator[tuple[Executor, RunDisplay, Callable[[GraphRunner], None]]]:
    """Yield an executor, the display that hears of it, and what a runner must be handed to."""
    with RunDisplay(console, out / "logs" / "run.log") as display:
        executor = workers.make(display.listen)
        try:
            with stop_on_signals(display.note) as on_ready:
                yield executor, display, on_ready
        finally:
            executor.close()


STOPPING = b"surmount: stopping at the next checkpoint; Ctrl-C again ends at once\n"


@contextmanager
def stop_on_signals(
    note: Callable[[str], None],
) -> Generator[Callable[[GraphRunner], None]]:
    """Let the first Ctrl-C (or SIGTERM) save and stop a runner, and the second end at once.

    Yields what is to be called with the runner; afterwards signals do what they did before, and
    that the run was asked to stop is noted. A signal may arrive within any call, also one that
    writes to the display or to the log: its handler uses neither.
    """
    runners: list[GraphRunner] = []
    asked = False

    def handle(_number: int, _frame: FrameType | None) -> None:
        nonlocal asked
        if asked:
            os._exit(INTERRUPTED)  # workers see that their parent has gone, and end too
        asked = True
        with suppress(OSError):
            os.write(2, STOPPING)
        for runner in runners:
            runner.stop()

    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, handle) for number in signals]
    try:
        yield runners.append
    finally:
        for number, previous in zip(signals, before, strict=True):
            signal.signal(number, previous)
        if asked:
            note("was asked to stop")
