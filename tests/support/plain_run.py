"""An experiment run with an executor and an observer of the test's own, without a display."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from surmount.experiment.config import ExperimentConfig
from surmount.experiment.protocol import protocol
from surmount.workflow.artefact_store import ArtefactStore
from surmount.workflow.executor import RETRIES, Executor
from surmount.workflow.graph import Stage
from surmount.workflow.journal import Journal
from surmount.workflow.runner import GraphRunner, RunObserver, RunOutcome
from surmount.workflow.store import output_errors


def run(
    root: Path,
    config: ExperimentConfig,
    executor: Executor,
    observer: RunObserver,
    *,
    on_ready: Callable[[GraphRunner], None] = lambda _: None,
    url: str | None = None,
    retries: int = RETRIES,
    stages: Iterable[Stage] | None = None,
) -> RunOutcome:
    """Run what is missing of an experiment in a folder that was begun."""
    runner = GraphRunner(
        root,
        protocol(config) if stages is None else stages,
        executor,
        Journal(root, observer),
        depot=ArtefactStore(root=root, url=url),
        retries=retries,
    )
    on_ready(runner)
    with output_errors(root):
        return runner.run()
