"""The protocol as a resumable graph of stages."""

from surmount.experiment.config import ExperimentConfig
from surmount.experiment.executors import Executor, InProcessExecutor, ProcessExecutor, StageEvent
from surmount.experiment.presets import SCALES, preset
from surmount.experiment.protocol import protocol
from surmount.experiment.reproduce import begin, load_config, make_executor, run
from surmount.experiment.runner import GraphRunner, RunObserver, RunOutcome

__all__ = [
    "SCALES",
    "Executor",
    "ExperimentConfig",
    "GraphRunner",
    "InProcessExecutor",
    "ProcessExecutor",
    "RunObserver",
    "RunOutcome",
    "StageEvent",
    "begin",
    "load_config",
    "make_executor",
    "preset",
    "protocol",
    "run",
]
