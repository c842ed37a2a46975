"""The protocol as a resumable graph of stages."""

from surmount.experiment.config import ExperimentConfig
from surmount.experiment.depot import Depot
from surmount.experiment.executor import Executor, StageEvent, StageResult, WorkerLostError
from surmount.experiment.graph import Resources, Stage
from surmount.experiment.in_process import InProcessExecutor
from surmount.experiment.local_processes import ProcessExecutor
from surmount.experiment.presets import SCALES, preset
from surmount.experiment.protocol import protocol
from surmount.experiment.reproduce import (
    begin,
    load_config,
    make_executor,
    refuse_other,
    run,
)
from surmount.experiment.runner import GraphRunner, RunObserver, RunOutcome

__all__ = [
    "SCALES",
    "Depot",
    "Executor",
    "ExperimentConfig",
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
    "begin",
    "load_config",
    "make_executor",
    "preset",
    "protocol",
    "refuse_other",
    "run",
]
