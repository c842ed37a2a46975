"""Stages and graph of a comparison of teachers at matched budgets.

A comparison is an experiment with more arms. The paper's curriculum and the uniform control are the
experiment's own; every other teacher trains each of its initial networks for as many steps as the
paper's curriculum took with that network, and is tested alike. So a finished experiment is taken
as it is, and teachers can be added one by one.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.result import Analysis
from surmount.core.configuration import from_record, to_record
from surmount.core.records import read_record
from surmount.experiment import stages
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.protocol import protocol
from surmount.experiment.task_part import family_and_settings, stage_seed, task_part
from surmount.experiment.teacher_statistics import compare_teachers
from surmount.experiment.trial_stages import trial_stages
from surmount.learn.snapshot import Snapshot
from surmount.tasks.regions import Regions
from surmount.tasks.space import harder_by_success
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.catalogue import (
    SETTINGS,
    TeacherContext,
    TeachersConfig,
    find_teacher,
    make_teacher,
)
from surmount.teachers.uniform import UniformTeacher
from surmount.workflow.graph import Stage, StageContext
from surmount.workflow.run_layout import ANALYSIS, TRIALS, per_network

OWN_ARMS = {"paper": "curriculum", "uniform": "control"}
"""Teachers that every experiment has, by the name of their stage."""
COMPARISON = "teachers"
"""Name of the stage that compares them."""


def training_stage(teacher: str, network: int) -> str:
    """Return the name of the stage in which a teacher trains a network."""
    return per_network(OWN_ARMS.get(teacher, f"teach/{teacher}"), network)


def test_stage(teacher: str, network: int) -> str:
    """Return the name of the stage that tests it."""
    own = OWN_ARMS.get(teacher)
    return per_network(f"test-teach/{teacher}" if own is None else TRIALS[own], network)


def comparison_graph(
    config: ExperimentConfig, teachers: tuple[str, ...], teaching: TeachersConfig
) -> list[Stage]:
    """Return the stages of an experiment with more teachers.

    Parameters
    ----------
    config
        The experiment.
    teachers
        Names of the teachers to compare; the paper's and the uniform one are always among them.
    teaching
        Their settings.
    """
    names = tuple(dict.fromkeys([*OWN_ARMS, *teachers]))
    for name in names:
        find_teacher(name)
    graph = protocol(config)
    for name in names:
        if name not in OWN_ARMS:
            for network in range(config.networks):
                graph += _arm(config, name, network, teaching)
    networks = range(config.networks)
    roles = {f"test:{name}": tuple(test_stage(name, i) for i in networks) for name in names}
    roles |= {f"training:{name}": tuple(training_stage(name, i) for i in networks)
              for name in names}  # fmt: skip
    graph.append(
        Stage(
            name=COMPARISON,
            function=compare_teachers,
            config={
                "teachers": list(names),
                "settings": {name: _settings(teaching, name) for name in names},
            },
            seed=stage_seed(config, COMPARISON),
            inputs={"analysis": (ANALYSIS,), **roles},
        )
    )
    return graph


def _arm(
    config: ExperimentConfig, teacher: str, network: int, teaching: TeachersConfig
) -> list[Stage]:
    record = to_record(config)
    own = _settings(teaching, teacher)
    name = training_stage(teacher, network)
    part: dict[str, Any] = {
        **task_part(config),
        **{key: record[key] for key in ("learner", "checkpoint_steps", "advancement", "analysis")},
        "teacher": teacher,
        "teaching": {SETTINGS[teacher]: own} if own else {},
    }
    train = Stage(
        name=name,
        function=learn_by_teacher,
        config=part,
        seed=stage_seed(config, name),
        inputs={
            "network": (per_network("initiation", network),),
            "analysis": (ANALYSIS,),
            "curriculum": (per_network("curriculum", network),),
        },
    )
    tested = test_stage(teacher, network)
    return [train, *trial_stages(config, tested, record["tests"], network, train.name)]


def _settings(teaching: TeachersConfig, teacher: str) -> dict[str, Any]:
    """Return a teacher's own settings; none of most."""
    return to_record(teaching)[SETTINGS[teacher]] if teacher in SETTINGS else {}


def learn_by_teacher(context: StageContext) -> None:
    """Train an initial network on by a teacher, for as long as the paper's curriculum took.

    A curriculum without levels took no steps: then no teacher teaches anything.
    """
    family, settings = family_and_settings(context.config)
    space = family.space(settings)
    analysis = Analysis.load(stages.only(context, "analysis").path(stages.ANALYSIS))
    steps = int(read_record(stages.only(context, "curriculum").path(stages.TRAINING))["steps"])
    config: Mapping[str, Any] = context.config
    teacher_context = TeacherContext(
        curriculum=analysis.curriculum,
        variants=analysis.variants,
        success_rate=analysis.success_rate,
        whole_range=space.whole_range,
        harder=space.harder or harder_by_success(analysis.variants, analysis.success_rate),
        total_steps=steps,
        seed=context.seed,
        environments=int(config["learner"]["num_envs"]),
        analysis=from_record(AnalysisConfig, config["analysis"]),
        advancement=from_record(AdvancementConfig, config["advancement"]),
        teachers=from_record(TeachersConfig, config["teaching"]),
    )
    start = Snapshot.load(stages.only(context, "network").path(stages.NETWORK))
    training = stages.train(
        context,
        make_teacher(str(config["teacher"]), teacher_context)
        if steps
        else UniformTeacher(teacher_context.whole_range, 0),
        start=start,
        regions=Regions.of(analysis.curriculum),
    )
    stages.write_training(context, training)
