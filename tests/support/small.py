"""The whole protocol, as small as it can be: seconds instead of hours, nothing left out."""

from __future__ import annotations

from pathlib import Path

from plain_run import run

from surmount.core.configuration import override
from surmount.core.records import read_record
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.presets import preset
from surmount.experiment.protocol import protocol
from surmount.experiment.running import begin
from surmount.workflow.executors import make_executor
from surmount.workflow.runner import GraphRunner

SMALL = {
    "networks": 2,
    "initial_steps": 600,
    "checkpoint_steps": 300,
    "env.step_s": 0.1,
    "env.episode_s": 2.0,
    "learner.hidden_layers": [16, 16],
    "learner.rollout_steps": 32,
    "learner.batch_size": 96,
    "trials.repetitions": 2,
    "tests.repetitions": 1,
    "analysis.components": 2,
    "analysis.bootstrap": 5,
    "advancement.iteration_steps": 600,
    "advancement.extension_steps": 300,
    "advancement.window_steps": 200,
    "advancement.max_extensions": 1,
}


def small_config(obstacle: str = "narrow-channel", **changes) -> ExperimentConfig:
    return override(preset(obstacle, "smoke"), SMALL | changes)


class Watcher:
    """Keeps what a run told."""

    def __init__(self):
        self.started, self.sentences, self.lost, self.outdated = [], [], [], []

    def stage_outdated(self, stage, folders):
        self.outdated.append(stage)

    def stage_reused(self, artefact):
        pass

    def stage_started(self, stage):
        self.started.append(stage)

    def stage_finished(self, artefact, seconds):
        pass

    def stage_lost(self, stage, *, again):
        self.lost.append(stage)

    def listen(self, event):
        if isinstance(event.told, str):
            self.sentences.append((event.stage, event.told))


def run_small(root: Path, config: ExperimentConfig, processes: int = 0, url=None, **options):
    begin(root, config)
    watcher = Watcher()
    executor = make_executor(processes, watcher.listen, **options)
    try:
        outcome = run(root, config, executor, watcher, url=url)
    finally:
        executor.close()
    return outcome, watcher


def run_first_stages(root: Path, config: ExperimentConfig, stages: int = 2) -> Path:
    """Train the first network and log its trials, and leave the run there."""
    begin(root, config)
    watcher = Watcher()
    executor = make_executor(0, watcher.listen)
    GraphRunner(root, protocol(config)[:stages], executor, watcher).run()
    return root


def content(root: Path) -> dict[str, dict[str, str]]:
    """Return the SHA-256 of every file of every finished stage."""
    return {
        path.parent.relative_to(root).as_posix(): read_record(path)["files"]
        for path in sorted(root.glob("stages/**/manifest.json"))
    }
