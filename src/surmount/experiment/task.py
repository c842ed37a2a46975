"""One stage, ready to be run anywhere: plain data in, a published artefact out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surmount.core.monitor import Monitor
from surmount.core.store import Artefact, ArtefactStore, output_errors
from surmount.experiment.graph import StageContext, StageFunction


@dataclass(frozen=True, kw_only=True)
class StageTask:
    """A stage whose inputs are finished, as it is sent to an executor.

    Attributes
    ----------
    root
        The output folder, on a path that every worker sees.
    name, key, function, config, seed
        As in :class:`surmount.experiment.graph.Stage`.
    inputs
        Artefacts by role.
    """

    root: Path
    name: str
    key: str
    function: StageFunction
    config: Mapping[str, Any]
    seed: int
    inputs: Mapping[str, tuple[Artefact, ...]]


def execute(task: StageTask, monitor: Monitor) -> Artefact:
    """Run a stage and publish its files.

    Raises
    ------
    Interrupted
        If the monitor asked the stage to stop.
    SurmountError
        Whatever the stage found wrong, and an output folder that cannot be written.
    """
    store = ArtefactStore(task.root)
    with output_errors(task.root):
        workspace = store.workspace(task.name, task.key)
        checkpoint = store.checkpoint_folder(task.name, task.key)
        checkpoint.mkdir(parents=True, exist_ok=True)
        task.function(
            StageContext(
                name=task.name,
                config=task.config,
                seed=task.seed,
                inputs=task.inputs,
                output=workspace,
                checkpoint=checkpoint,
                logs=task.root / "logs" / task.name,
                monitor=monitor,
            )
        )
        inputs = {
            artefact.stage: artefact.content_hash
            for artefacts in task.inputs.values()
            for artefact in artefacts
        }
        return store.commit(workspace, task.name, task.key, inputs=inputs)
