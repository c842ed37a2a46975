"""Running stages with progress for people, stopping cleanly when asked to."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

from rich.console import Console

from surmount.workflow.artefact_store import ArtefactStore
from surmount.workflow.display import RunDisplay
from surmount.workflow.executor import RETRIES, Executor, Listener
from surmount.workflow.graph import Stage
from surmount.workflow.runner import GraphRunner, RunObserver, RunOutcome
from surmount.workflow.store import output_errors

INTERRUPTED = 130
"""Exit code of a process that was asked to stop."""


def run_graph(
    root: Path,
    graph: Iterable[Stage],
    make_executor: Callable[[Listener], Executor],
    console: Console,
    *,
    store: str | None = None,
    retries: int = RETRIES,
    observed_by: Callable[[RunObserver], RunObserver] = lambda display: display,
) -> RunOutcome:
    """Run stages into a folder with progress, stopping cleanly at Ctrl-C.

    Parameters
    ----------
    root
        The output folder.
    graph
        The stages.
    make_executor
        Makes what runs them, given who is to be told what they tell.
    console
        Where progress is shown.
    store
        URL of an object store that has the same stages as the folder.
    retries
        How often a stage is run again after its worker was lost.
    observed_by
        Wraps the display in another observer, which must pass on what it hears.
    """
    with RunDisplay(console, root / "logs" / "run.log") as display, output_errors(root):
        executor = make_executor(display.listen)
        try:
            with stop_on_signals(display.note) as on_ready:
                runner = GraphRunner(
                    root,
                    graph,
                    executor,
                    observed_by(display),
                    depot=ArtefactStore(root=root, url=store),
                    retries=retries,
                )
                on_ready(runner)
                return runner.run()
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

    if threading.current_thread() is not threading.main_thread():  # only it may handle signals
        yield runners.append
        return
    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, handle) for number in signals]
    try:
        yield runners.append
    finally:
        for number, previous in zip(signals, before, strict=True):
            signal.signal(number, previous)
        if asked:
            note("was asked to stop")
