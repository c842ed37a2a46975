"""The record of all episodes of a training, which the experiment measures and the report shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.records import read_record
from surmount.workflow.run_layout import EPISODES_FILE, TRAINING_FILE
from surmount.workflow.store import Artefact


@dataclass(frozen=True, kw_only=True, eq=False)
class TrainingEpisodes:
    """All episodes of one network's training.

    Attributes
    ----------
    budget
        Learning steps of the training.
    steps
        Learning steps at which each episode ended, ascending, ``(episode,)``.
    tasks
        Task of each, ``(episode, parameter)``.
    success
        Whether it succeeded, ``(episode,)``.
    reward
        Sum of its unnormalised rewards, ``(episode,)``.
    length
        Steps that it took, ``(episode,)``.
    """

    budget: int
    steps: IntArray
    tasks: FloatArray
    success: BoolArray
    reward: FloatArray
    length: IntArray


def read_episodes(artefact: Artefact, parameters: Sequence[str]) -> TrainingEpisodes:
    """Read the episodes of a training stage."""
    import polars as pl  # noqa: PLC0415 - optional, only where Parquet is asked for

    table = pl.read_parquet(artefact.path(EPISODES_FILE), glob=False)
    columns = [f"variant.{name}" for name in parameters]
    return TrainingEpisodes(
        budget=int(read_record(artefact.path(TRAINING_FILE))["steps"]),
        steps=table["steps"].to_numpy().astype(np.int64),
        tasks=table.select(columns).to_numpy().astype(np.float64),
        success=table["success"].to_numpy().astype(np.bool_),
        reward=table["reward"].to_numpy().astype(np.float64),
        length=table["length"].to_numpy().astype(np.int64),
    )
