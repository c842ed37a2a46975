"""One stage at work, with one thread, wherever it runs."""

from __future__ import annotations

import time

import torch
from threadpoolctl import threadpool_limits

from surmount.workflow.executor import StageResult
from surmount.workflow.monitor import Monitor
from surmount.workflow.stage_task import StageTask, execute


def run_timed(task: StageTask, monitor: Monitor) -> StageResult:
    """Run a stage with one thread, and measure how long it takes.

    Sums in matrix products depend on the number of threads; one everywhere gives the same bytes.
    """
    torch.set_num_threads(1)
    began = time.monotonic()
    with threadpool_limits(1):
        artefact = execute(task, monitor)
    return StageResult(artefact=artefact, seconds=time.monotonic() - began)
