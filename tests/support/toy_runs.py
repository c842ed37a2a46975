"""Small graphs of toy stages, and an observer that keeps what it was told."""

from __future__ import annotations

import toy_stages

from surmount.workflow.graph import Stage
from surmount.workflow.in_process import InProcessExecutor
from surmount.workflow.local_processes import ProcessExecutor
from surmount.workflow.runner import GraphRunner


class Observer:
    def __init__(self):
        self.reused, self.started, self.finished, self.told, self.lost = [], [], [], [], []
        self.outdated = []

    def stage_outdated(self, stage, folders):
        self.outdated.append(stage)

    def stage_reused(self, artefact):
        self.reused.append(artefact.stage)

    def stage_started(self, stage):
        self.started.append(stage)

    def stage_finished(self, artefact, seconds):
        self.finished.append(artefact.stage)

    def stage_lost(self, stage, *, again):
        self.lost.append((stage, again))

    def listen(self, event):
        self.told.append(event)

    @property
    def sentences(self):
        return [(e.stage, e.told) for e in self.told if isinstance(e.told, str)]


def graph(n=1, seed=0):
    parts = [
        Stage(name=f"part/{i}", kind=toy_stages.KINDS["number"], config={"n": n * i}, seed=seed)
        for i in range(3)
    ]
    names = tuple(stage.name for stage in parts)
    return [Stage(name="total", kind=toy_stages.KINDS["total"], inputs={"parts": names}), *parts]


def run(root, stages, processes=0):
    observer = Observer()
    executor = (
        ProcessExecutor(processes, observer.listen)
        if processes
        else InProcessExecutor(observer.listen)
    )
    try:
        return GraphRunner(root, stages, executor, observer).run(), observer
    finally:
        executor.close()
