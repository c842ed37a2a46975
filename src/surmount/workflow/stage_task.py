"""One stage, ready to be run anywhere: plain data in, a published artefact out."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from surmount.workflow.artefact_store import ArtefactStore
from surmount.workflow.graph import Resources, StageContext, StageFunction
from surmount.workflow.monitor import Interrupted, Monitor
from surmount.workflow.store import Artefact, output_errors


@dataclass(frozen=True, kw_only=True)
class StageTask:
    """A stage whose inputs are finished, as it is sent to an executor.

    Attributes
    ----------
    depot
        Where its inputs are and its files go.
    name, key, config, seed, resources
        As in :class:`surmount.workflow.graph.Stage`.
    function
        Of the stage's kind.
    inputs
        Artefacts by role.
    """

    depot: ArtefactStore
    name: str
    key: str
    function: StageFunction
    config: Mapping[str, Any]
    seed: int
    inputs: Mapping[str, tuple[Artefact, ...]]
    resources: Resources = field(default_factory=Resources)

    def at(self, depot: ArtefactStore) -> StageTask:
        """Return the same task with its files in another place."""
        return replace(self, depot=depot)


def execute(task: StageTask, monitor: Monitor) -> Artefact:
    """Run a stage and publish its files.

    Raises
    ------
    Interrupted
        If the monitor asked the stage to stop.
    SurmountError
        Whatever the stage found wrong, and an output folder that cannot be written.
    """
    depot = task.depot
    with output_errors(depot.root):
        workspace = depot.store.workspace(task.name, task.key)
        checkpoints = depot.checkpoints(task.name, task.key)
        watched = checkpoints.watched(monitor)
        inputs = {
            role: tuple(depot.bring(artefact) for artefact in artefacts)
            for role, artefacts in task.inputs.items()
        }
        try:
            task.function(
                StageContext(
                    name=task.name,
                    config=task.config,
                    seed=task.seed,
                    inputs=inputs,
                    output=workspace,
                    checkpoint=checkpoints.folder,
                    logs=depot.root / "logs" / task.name,
                    monitor=watched,
                )
            )
        except BaseException as error:
            shutil.rmtree(workspace, ignore_errors=True)
            if isinstance(error, Interrupted):
                checkpoints.save()
            raise
        hashes = {
            artefact.stage: artefact.content_hash
            for artefacts in inputs.values()
            for artefact in artefacts
        }
        return depot.commit(workspace, task.name, task.key, inputs=hashes)
