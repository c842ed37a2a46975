"""The stage that compares teachers: scores over networks, speed, and what each sampled."""

from __future__ import annotations

from typing import Any

import numpy as np

from surmount.analysis.result import Analysis
from surmount.core.arrays import FloatArray, IntArray
from surmount.core.records import read_record, write_record
from surmount.experiment.learning_speed import WINDOW, steps_to_95
from surmount.experiment.stages import pooled_trials
from surmount.experiment.statistics import success_matrix
from surmount.learn.training_episodes import TrainingEpisodes, read_episodes
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.differences import network_difference
from surmount.stats.evidence import (
    bootstrap_interval,
    difference_interval,
    probability_of_improvement,
)
from surmount.tasks.cells import TaskCells
from surmount.tasks.curriculum import Curriculum
from surmount.teachers.catalogue import find_teacher
from surmount.workflow.graph import StageContext
from surmount.workflow.run_layout import ANALYSIS_FILE, COMPARISON_FILE, SCHEMA, TRAINING_FILE
from surmount.workflow.store import Artefact

REFERENCES = ("paper", "uniform")
"""Teachers that each of the others is compared with."""
TIME_BINS = 20
"""Parts of each training, in which what was sampled is counted."""

Record = dict[str, Any]


def compare_teachers(context: StageContext) -> None:
    """Write ``teachers.json``."""
    (artefact,) = context.inputs["analysis"]
    analysis = Analysis.load(artefact.path(ANALYSIS_FILE))
    curriculum = analysis.curriculum
    bootstrap = Bootstrap(seed=context.seed)
    names: list[str] = list(context.config["teachers"])
    scores = {name: success_matrix(pooled_trials(context.inputs[f"test:{name}"]))
              for name in names}  # fmt: skip
    groups = curriculum.groups_of(analysis.variants)
    cells = TaskCells(analysis.parameters, analysis.variants)
    write_record(
        context.output / COMPARISON_FILE,
        {
            "schema": SCHEMA,
            "parameters": list(analysis.parameters),
            "variants": analysis.variants.tolist(),
            "groups": [group.name for group in curriculum.groups],
            "group_of_variant": groups.tolist(),
            "window_episodes": WINDOW,
            "teachers": [
                {
                    "name": name,
                    "title": find_teacher(name).title,
                    "source": find_teacher(name).source,
                    "settings": context.config["settings"][name],
                    **_scores(scores, name, groups, curriculum, bootstrap),
                    **_training(context.inputs[f"training:{name}"], curriculum, cells),
                }
                for name in names
            ],
        },
    )


def _scores(
    scores: dict[str, FloatArray],
    name: str,
    groups: IntArray,
    curriculum: Curriculum,
    bootstrap: Bootstrap,
) -> Record:
    own = scores[name]
    against: Record = {}
    for other in REFERENCES:
        if other != name:
            against[other] = {
                "difference": difference_interval(
                    own, scores[other], bootstrap, paired=True
                ).to_record(),
                "mean_difference": network_difference(own, scores[other], paired=True).to_record(),
                "probability_of_improvement": probability_of_improvement(
                    own, scores[other], bootstrap, paired=True
                ).to_record(),
            }
    return {
        "success": own.tolist(),
        "interquartile_mean": bootstrap_interval(own, bootstrap).to_record(),
        "mean_by_group": [
            bootstrap_interval(own[:, groups == group], bootstrap, statistic=_mean).to_record()
            for group in range(len(curriculum.groups))
        ],
        "against": against,
    }


def _mean(values: FloatArray) -> float:
    return float(values.mean())


def _training(artefacts: tuple[Artefact, ...], curriculum: Curriculum, cells: TaskCells) -> Record:
    trainings = [read_episodes(one, curriculum.parameters) for one in artefacts]
    counts = np.zeros((TIME_BINS, cells.count))
    for training in trainings:
        counts += _sampled(training, cells)
    return {
        "steps": [training.budget for training in trainings],
        **_changes(artefacts),
        "sampled": counts.tolist(),
        "steps_to_95": [found.to_record() for found in steps_to_95(trainings, curriculum)],
    }


def _changes(artefacts: tuple[Artefact, ...]) -> Record:
    """Return each network's changes of a teacher that tells of them; nothing of the others."""
    records = [read_record(one.path(TRAINING_FILE)) for one in artefacts]
    changes = [record.get("changes", []) for record in records]
    return {"changes": changes} if any(changes) else {}


def _sampled(training: TrainingEpisodes, cells: TaskCells) -> FloatArray:
    """Count the episodes of each part of the training on each variant, ``(part, variant)``."""
    counts = np.zeros((TIME_BINS, cells.count))
    part = np.minimum((training.steps - 1) * TIME_BINS // max(training.budget, 1), TIME_BINS - 1)
    for row, task in zip(part, training.tasks, strict=True):
        counts[row, cells.locate(task)] += 1
    return counts
