"""The protocol as a resumable graph of stages."""

from surmount.experiment.config import ExperimentConfig
from surmount.experiment.presets import SCALES, preset
from surmount.experiment.protocol import protocol
from surmount.experiment.running import (
    begin,
    load_config,
    make_executor,
    refuse_other,
    run,
)

__all__ = [
    "SCALES",
    "ExperimentConfig",
    "begin",
    "load_config",
    "make_executor",
    "preset",
    "protocol",
    "refuse_other",
    "run",
]
