"""Running a graph of stages that is not one experiment: maps over many settings."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from surmount.cli.display import RunDisplay
from surmount.cli.reproduce import stop_on_signals
from surmount.cli.workers import Workers
from surmount.core.store import output_errors
from surmount.experiment import Depot, GraphRunner, RunOutcome, Stage


def run_graph(out: Path, graph: list[Stage], workers: Workers, console: Console) -> RunOutcome:
    """Run stages into a folder with progress, stopping cleanly at Ctrl-C."""
    with RunDisplay(console, out / "logs" / "run.log") as display:
        executor = workers.make(display.listen)
        depot = Depot(root=out, url=workers.store)
        runner = GraphRunner(out, graph, executor, display, depot=depot, retries=workers.retries)
        try:
            with stop_on_signals(display.note) as on_ready, output_errors(out):
                on_ready(runner)
                return runner.run()
        finally:
            executor.close()
