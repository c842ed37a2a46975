"""The stage in which a teacher of the comparison trains a network at a charged budget."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.result import Analysis
from surmount.core.arrays import FloatArray
from surmount.core.configuration import from_record
from surmount.envs.family import TaskFamily
from surmount.experiment.stages import only, train, write_training
from surmount.experiment.task_part import family_and_settings
from surmount.studies.teachers.plan import ORACLE
from surmount.tasks.cells import TaskCells
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.regions import Regions
from surmount.tasks.space import TaskSpace, harder_by_success
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.catalogue import (
    TeacherContext,
    TeachersConfig,
    find_teacher,
    make_teacher,
)
from surmount.teachers.teacher import Teacher
from surmount.teachers.uniform import UniformTeacher
from surmount.trials.table import read_trials
from surmount.trials.trials import Trials
from surmount.workflow.graph import StageContext, StageKind
from surmount.workflow.run_layout import ANALYSIS_FILE, TRIALS_FILE

HARD_SHARE = 0.5
"""Share of the oracle's tasks that come from the hard third."""


def learn_at_charged_budget(context: StageContext) -> None:
    """Train an initial network on by a teacher; one that needs groups pays for its trials."""
    family, settings = family_and_settings(context.config)
    config: Mapping[str, Any] = context.config
    space = family.space(settings)
    analysis = Analysis.load(only(context, "analysis").path(ANALYSIS_FILE))
    name, budget = str(config["teacher"]), int(config["budget_steps"])
    if name != ORACLE and find_teacher(name).by_trials:
        spent = steps_of(read_trials(only(context, "trials").path(TRIALS_FILE)))
        context.monitor.log(f"{spent:,} of {budget:,} steps are charged for the trials")
        budget = max(0, budget - spent)
    teacher = _teacher(name, budget, context, family, settings, space, analysis)
    start = only(context, "network")
    training = train(context, teacher, start=start, regions=Regions.of(analysis.curriculum))
    write_training(context, training)


LEARN = StageKind(name="study-teacher", function=learn_at_charged_budget)
"""Stages of the comparison in which a teacher trains."""


def steps_of(trials: Trials) -> int:
    """Return the steps that trials took: rows of the log but for each trial's first."""
    return int(trials.features.shape[0] - trials.success.size)


def oracle_tasks(
    family: TaskFamily, settings: Any, analysis: Analysis, target: TaskDistribution | None
) -> TaskDistribution:
    """Return half of the tasks over the whole range and half from what is hard.

    Hard are the target tasks, where these are wanted; else the third of the variants at the hard
    end of the parameters, or by what else the family knows of difficulty; else the third that
    succeeds least after the initiation.
    """
    space = family.space(settings)
    whole = space.whole_range
    hard = target
    if hard is None:
        cells = TaskCells(analysis.parameters, analysis.variants, space.axes)
        hard = cells.distribution(_hard(family, space, analysis))
    return TaskDistribution(
        parameters=whole.parameters,
        weights=np.concatenate([(1 - HARD_SHARE) * whole.weights, HARD_SHARE * hard.weights]),
        lower=np.concatenate([whole.lower, hard.lower]),
        upper=np.concatenate([whole.upper, hard.upper]),
        axes=whole.axes,
    )


def _hard(family: TaskFamily, space: TaskSpace, analysis: Analysis) -> FloatArray:
    variants = analysis.variants
    third = max(1, round(len(variants) / 3))
    if space.harder is not None:
        order = TaskCells(analysis.parameters, variants, space.axes).by_difficulty(space.harder)
        return np.isin(np.arange(len(variants)), order[-third:]).astype(np.float64)
    known = family.difficulty(variants)
    order = np.argsort(analysis.success_rate if known is None else -known, kind="stable")
    return np.isin(np.arange(len(variants)), order[:third]).astype(np.float64)


def _teacher(
    name: str,
    steps: int,
    context: StageContext,
    family: TaskFamily,
    settings: Any,
    space: TaskSpace,
    analysis: Analysis,
) -> Teacher:
    config: Mapping[str, Any] = context.config
    target = family.target(settings) if config["towards"] == "target" else None
    if name == ORACLE:
        tasks = oracle_tasks(family, settings, analysis, target)
        return UniformTeacher(tasks, steps, label=ORACLE)
    if find_teacher(name).by_trials and not analysis.curriculum.levels:
        context.monitor.log("every group already succeeds: uniform tasks instead of a curriculum")
        return UniformTeacher(space.whole_range, steps, seed=context.seed)
    return make_teacher(
        name,
        TeacherContext(
            curriculum=analysis.curriculum,
            variants=analysis.variants,
            success_rate=analysis.success_rate,
            whole_range=space.whole_range,
            harder=space.harder
            or harder_by_success(analysis.variants, analysis.success_rate, analysis.axes),
            total_steps=steps,
            seed=context.seed,
            environments=int(config["learner"]["num_envs"]),
            target=target,
            analysis=from_record(AnalysisConfig, config["analysis"]),
            advancement=from_record(AdvancementConfig, config["advancement"]),
            teachers=from_record(TeachersConfig, config["teaching"]),
        ),
    )
