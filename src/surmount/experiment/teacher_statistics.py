"""The stage that compares teachers: scores over networks, speed, and what each sampled."""

from __future__ import annotations

from typing import Any

import numpy as np
import polars as pl

from surmount.analysis import Analysis
from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.curriculum import Curriculum
from surmount.core.records import read_record, write_record
from surmount.core.regions import Regions
from surmount.core.run_layout import SCHEMA
from surmount.core.store import Artefact
from surmount.experiment.graph import StageContext
from surmount.experiment.history_tables import EPISODES
from surmount.experiment.stages import ANALYSIS, TRAINING, pooled_trials
from surmount.experiment.statistics import success_matrix
from surmount.stats import (
    Bootstrap,
    bootstrap_interval,
    difference_interval,
    network_difference,
    probability_of_improvement,
    steps_to_threshold,
)
from surmount.teachers import TaskCells, find_teacher

FILE = "teachers.json"
REFERENCES = ("paper", "uniform")
"""Teachers that each of the others is compared with."""
EVALUATIONS = 40
"""Moments, evenly over the longest training, at which success in training is looked at."""
WINDOW = 30
"""Newest episodes of a group that make its success in training."""
FEWEST = 10
"""Episodes of a group below which its success in training counts as not known."""
TIME_BINS = 20
"""Parts of each training, in which what was sampled is counted."""

Record = dict[str, Any]


def compare_teachers(context: StageContext) -> None:
    """Write ``teachers.json``."""
    (artefact,) = context.inputs["analysis"]
    analysis = Analysis.load(artefact.path(ANALYSIS))
    curriculum = analysis.curriculum
    bootstrap = Bootstrap(seed=context.seed)
    names: list[str] = list(context.config["teachers"])
    scores = {name: success_matrix(pooled_trials(context.inputs[f"test:{name}"]))
              for name in names}  # fmt: skip
    groups = curriculum.groups_of(analysis.variants)
    cells = TaskCells(analysis.parameters, analysis.variants)
    write_record(
        context.output / FILE,
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
    budgets = [int(read_record(one.path(TRAINING))["steps"]) for one in artefacts]
    tables = [pl.read_parquet(one.path(EPISODES)) for one in artefacts]
    regions = Regions.of(curriculum)
    moments = np.linspace(0, max(*budgets, 1), EVALUATIONS + 1)[1:]
    counts = np.zeros((TIME_BINS, cells.count))
    rates = np.zeros((len(curriculum.groups), len(artefacts), EVALUATIONS))
    for network, table in enumerate(tables):
        steps = table["steps"].to_numpy().astype(np.int64)
        columns = [f"variant.{name}" for name in curriculum.parameters]
        tasks = table.select(columns).to_numpy().astype(np.float64)
        success = table["success"].to_numpy().astype(np.bool_)
        counts += _sampled(steps, tasks, budgets[network], cells)
        owner = regions.index(tasks)
        for group in range(len(curriculum.groups)):
            own = owner == group
            rates[group, network] = success_in_training(steps[own], success[own], moments)
    return {
        "steps": budgets,
        "sampled": counts.tolist(),
        "steps_to_95": [steps_to_threshold(moments, rate).to_record() for rate in rates],
    }


def success_in_training(steps: IntArray, success: BoolArray, moments: FloatArray) -> FloatArray:
    """Return the success of the newest :data:`WINDOW` episodes at each moment.

    0 as long as there are fewer than :data:`FEWEST`.

    Parameters
    ----------
    steps, success
        Of a group's episodes in the order in which they ended, ``(episode,)``.
    moments
        Learning steps, ``(moment,)``.
    """
    rates = np.zeros(moments.size)
    for index, ended in enumerate(np.searchsorted(steps, moments, side="right")):
        if ended >= FEWEST:
            rates[index] = success[max(0, ended - WINDOW) : ended].mean()
    return rates


def _sampled(steps: IntArray, tasks: FloatArray, budget: int, cells: TaskCells) -> FloatArray:
    """Count the episodes of each part of the training on each variant, ``(part, variant)``."""
    counts = np.zeros((TIME_BINS, cells.count))
    part = np.minimum((steps - 1) * TIME_BINS // max(budget, 1), TIME_BINS - 1)
    for row, task in zip(part, tasks, strict=True):
        counts[row, cells.locate(task)] += 1
    return counts
