"""The results of a run as the page needs them, each read from an artefact with a checked hash."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl

from surmount.analysis.result import Analysis
from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.core.reading import read_as
from surmount.learn.training_episodes import TrainingEpisodes, read_episodes
from surmount.report.comparison import Comparison, comparison_of
from surmount.report.evidence import Evidence, Findings, family_of
from surmount.report.films import FilmedTrial, read_films
from surmount.report.outcomes import Outcomes, read_outcomes
from surmount.tasks.curriculum import Curriculum
from surmount.teachers.teacher import LevelTest
from surmount.workflow.run_folder import RunFolder, open_run
from surmount.workflow.run_layout import (
    ANALYSIS,
    ANALYSIS_FILE,
    ARMS,
    CURRICULUM_FILE,
    EPISODES_FILE,
    EVIDENCE,
    EVIDENCE_FILE,
    HISTORY_FILE,
    STATISTICS,
    STATISTICS_FILE,
    TRAINING_FILE,
    TRAININGS,
    TRIALS,
    read_run_record,
)
from surmount.workflow.store import Artefact


@dataclass(frozen=True, kw_only=True, eq=False)
class TrainingResult:
    """How one network's training went.

    Attributes
    ----------
    steps
        Learning steps since this training began, at the end of each roll-out, ``(rollout,)``.
    reward
        Mean reward per learning step, before any normalisation, ``(rollout,)``.
    success
        Share of the episodes that succeeded; ``None`` where none ended in the roll-out.
    label
        What was being learnt after each roll-out.
    total_steps, episodes, diverged_episodes
        Learning steps in all, episodes that ended, and those ended because the physics diverged.
    level_tests
        Every test of eq. 5, in order.
    skipped_updates, undone_rollouts
        Updates left out and roll-outs undone because numbers were not finite or exploded.
    record
        All its episodes; ``None`` where they were not recorded, and of the initiation.
    """

    steps: IntArray
    reward: FloatArray
    success: tuple[float | None, ...]
    label: tuple[str, ...]
    total_steps: int
    episodes: int
    diverged_episodes: int
    level_tests: tuple[LevelTest, ...]
    skipped_updates: int = 0
    undone_rollouts: int = 0
    record: TrainingEpisodes | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class RunResults:
    """Everything the page shows; what the run has not finished is absent.

    Attributes
    ----------
    folder
        The output folder.
    analysis
        From trials to curriculum.
    comparison
        Of both arms, as ``statistics.json`` has it.
    trainings
        By what was trained (``"initiation"``, ``"curriculum"``, ``"control"``) and network.
    tests
        By what had been trained.
    films
        Trials on film.
    evidence
        What is concluded from all of it.
    """

    folder: RunFolder
    analysis: Analysis | None
    comparison: Comparison | None
    trainings: Mapping[str, Mapping[int, TrainingResult]]
    tests: Mapping[str, Outcomes]
    films: tuple[FilmedTrial, ...]
    evidence: Evidence


def read_run(root: Path) -> RunResults:
    """Read a run's artefacts.

    Raises
    ------
    SurmountError
        As :func:`~surmount.workflow.run_folder.open_run`; an ``IntegrityError`` for every artefact
        whose content does not fit its hash.
    """
    folder = open_run(root)
    analysis = comparison = None
    if ANALYSIS in folder.stages:
        artefact = folder.stages[ANALYSIS]
        analysis = Analysis.load(artefact.path(ANALYSIS_FILE))
        _require_same_curriculum(analysis, artefact)
    if STATISTICS in folder.stages:
        path = folder.stages[STATISTICS].path(STATISTICS_FILE)
        record = read_run_record(path)
        with reading(path):
            comparison = comparison_of(record)
    tests = {
        kind: read_outcomes(artefacts.values())
        for kind, stage in TRIALS.items()
        if (artefacts := folder.numbered(stage))
    }
    findings = Findings(analysis=analysis, comparison=comparison, tests=tests)
    return RunResults(
        folder=folder,
        analysis=analysis,
        comparison=comparison,
        trainings={
            kind: {
                network: _training(artefact, analysis if kind in ARMS else None)
                for network, artefact in folder.numbered(kind).items()
            }
            for kind in TRAININGS
        },
        tests=tests,
        films=read_films(folder),
        evidence=_evidence(folder, findings),
    )


@contextmanager
def reading(path: Path) -> Generator[None]:
    """Turn what goes wrong with a file of another version into one sentence."""
    try:
        yield
    except (KeyError, TypeError, ValueError, AttributeError, pl.exceptions.PolarsError) as error:
        raise InputError(
            f"{path} does not have the form this version reads ({type(error).__name__}: {error}).",
            remedy="Use the version of Surmount that wrote it, or run the experiment again.",
        ) from error


def _evidence(folder: RunFolder, findings: Findings) -> Evidence:
    """Return the evidence that a run keeps, or draw it from what an unfinished one has."""
    if EVIDENCE not in folder.stages:
        return Evidence.of(family_of(folder.task), findings)
    path = folder.stages[EVIDENCE].path(EVIDENCE_FILE)
    record = read_run_record(path)
    with reading(path):
        return read_as(Evidence, record)


def _require_same_curriculum(analysis: Analysis, artefact: Artefact) -> None:
    """Refuse a folder in which the curriculum that was learnt is not the one that was found."""
    path = artefact.path(CURRICULUM_FILE)
    if Curriculum.load(path).to_record() != analysis.curriculum.to_record():
        raise InputError(
            f"{path} is not the curriculum of the analysis beside it.",
            remedy="Run the experiment again.",
        )


def _training(artefact: Artefact, analysis: Analysis | None) -> TrainingResult:
    path, table = artefact.path(TRAINING_FILE), artefact.path(HISTORY_FILE)
    record = read_run_record(path)
    with reading(table):
        history = pl.read_parquet(table, glob=False)
        steps = history["steps"].to_numpy().astype(np.int64)
        reward = history["reward"].to_numpy().astype(np.float64)
        success = [None if value is None else float(value) for value in history["success"]]
        label = [str(value) for value in history["label"]]
    with reading(path):
        return TrainingResult(
            steps=steps,
            reward=reward,
            success=tuple(success),
            label=tuple(label),
            total_steps=int(record["steps"]),
            episodes=int(record["episodes"]),
            diverged_episodes=int(record["diverged_episodes"]),
            level_tests=read_as(tuple[LevelTest, ...], record["level_tests"]),
            record=_episodes(artefact, analysis),
            **{name: int(count) for name, count in record.get("faults", {}).items()},
        )


def _episodes(artefact: Artefact, analysis: Analysis | None) -> TrainingEpisodes | None:
    if analysis is None or EPISODES_FILE not in artefact.files:
        return None
    with reading(artefact.path(EPISODES_FILE)):
        return read_episodes(artefact, analysis.parameters)
