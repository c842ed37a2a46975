"""The results of a run as the page needs them, each read from an artefact with a checked hash."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
import polars as pl

from surmount.analysis.result import Analysis
from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.learn.training_episodes import TrainingEpisodes, read_episodes
from surmount.report.comparison import Comparison, comparison_of
from surmount.report.sections.film import FilmedTrial, read_films
from surmount.tasks.curriculum import Curriculum
from surmount.teachers.teacher import LevelTest
from surmount.trials.table import read_trials
from surmount.trials.trials import Trials, success_rates
from surmount.workflow.run_folder import RunFolder, open_run
from surmount.workflow.run_layout import (
    ANALYSIS,
    ANALYSIS_FILE,
    CURRICULUM_FILE,
    EPISODES_FILE,
    HISTORY_FILE,
    STATISTICS,
    STATISTICS_FILE,
    TRAINING_FILE,
    TRAININGS,
    TRIALS,
    TRIALS_FILE,
    read_run_record,
)
from surmount.workflow.store import Artefact

PATHS = ("sprawl_deg", "fbem_deg")
"""Features whose path lengths the paper compares (III-D)."""


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
        All its episodes; ``None`` where they were not recorded, or there were no levels.
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
class Outcomes:
    """What the trials of all networks after one stage of learning came to.

    Attributes
    ----------
    parameters
        Names of the task parameters.
    variant
        Shape ``(trial, parameter)``.
    network, repetition, success
        Shape ``(trial,)`` each.
    path_lengths
        Σ|Δ| of each feature of :data:`PATHS` that was logged, ``(trial,)``.
    """

    parameters: tuple[str, ...]
    variant: FloatArray
    network: IntArray
    repetition: IntArray
    success: BoolArray
    path_lengths: Mapping[str, FloatArray]

    def scores(self) -> FloatArray:
        """Return each network's success rate on each variant, shape ``(network, variant)``."""
        return success_rates(self.variant, self.network, self.success)


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
    """

    folder: RunFolder
    analysis: Analysis | None
    comparison: Comparison | None
    trainings: Mapping[str, Mapping[int, TrainingResult]]
    tests: Mapping[str, Outcomes]
    films: tuple[FilmedTrial, ...]


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
    return RunResults(
        folder=folder,
        analysis=analysis,
        comparison=comparison,
        trainings={
            kind: {
                network: _training(artefact, analysis)
                for network, artefact in folder.numbered(kind).items()
            }
            for kind in TRAININGS
        },
        tests={
            kind: _tests(artefacts)
            for kind, stage in TRIALS.items()
            if (artefacts := folder.numbered(stage))
        },
        films=read_films(folder),
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
        history = pl.read_parquet(table)
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
            level_tests=tuple(
                LevelTest(**cast(dict[str, Any], test)) for test in record["level_tests"]
            ),
            record=_episodes(artefact, analysis) if record["level_tests"] else None,
            **{name: int(count) for name, count in record.get("faults", {}).items()},
        )


def _episodes(artefact: Artefact, analysis: Analysis | None) -> TrainingEpisodes | None:
    if analysis is None or EPISODES_FILE not in artefact.files:
        return None
    with reading(artefact.path(EPISODES_FILE)):
        return read_episodes(artefact, analysis.parameters)


def _tests(artefacts: Mapping[int, Artefact]) -> Outcomes:
    parts = [_outcomes(read_trials(artefact.path(TRIALS_FILE))) for artefact in artefacts.values()]
    paths = [name for name in PATHS if all(name in part.path_lengths for part in parts)]
    return Outcomes(
        parameters=parts[0].parameters,
        variant=np.concatenate([part.variant for part in parts]),
        network=np.concatenate([part.network for part in parts]),
        repetition=np.concatenate([part.repetition for part in parts]),
        success=np.concatenate([part.success for part in parts]),
        path_lengths={
            name: np.concatenate([part.path_lengths[name] for part in parts]) for name in paths
        },
    )


def _outcomes(trials: Trials) -> Outcomes:
    return Outcomes(
        parameters=trials.parameters,
        variant=trials.variant,
        network=trials.network,
        repetition=trials.repetition,
        success=trials.success,
        path_lengths={
            name: trials.path_length(name) for name in PATHS if name in trials.feature_names
        },
    )
