"""Stages as a graph, and where they run and are kept: nothing of reinforcement learning."""

from surmount.workflow.artefact_store import ArtefactStore
from surmount.workflow.executor import Executor, StageEvent, StageResult, WorkerLostError
from surmount.workflow.graph import Resources, Stage
from surmount.workflow.in_process import InProcessExecutor
from surmount.workflow.local_processes import ProcessExecutor
from surmount.workflow.runner import GraphRunner, RunObserver, RunOutcome

__all__ = [
    "ArtefactStore",
    "Executor",
    "GraphRunner",
    "InProcessExecutor",
    "ProcessExecutor",
    "Resources",
    "RunObserver",
    "RunOutcome",
    "Stage",
    "StageEvent",
    "StageResult",
    "WorkerLostError",
]
