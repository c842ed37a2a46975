"""The graph of a comparison of teachers at matched budgets.

A comparison is an experiment with more arms. The paper's curriculum and the uniform control are the
experiment's own; every other teacher trains each of its initial networks for as many steps as the
paper's curriculum took with that network, and is tested alike. So a finished experiment is taken
as it is, and teachers can be added one by one.
"""

from __future__ import annotations

from typing import Any

from surmount.core.configuration import key_record
from surmount.experiment import kinds
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.protocol import protocol
from surmount.experiment.task_part import stage_seed, task_part
from surmount.experiment.trial_stages import trial_stages
from surmount.teachers.catalogue import (
    SETTINGS,
    TeachersConfig,
    require_fit,
)
from surmount.workflow.graph import Stage
from surmount.workflow.run_layout import (
    ANALYSIS,
    COMPARISON,
    CONTROL,
    CURRICULUM,
    INITIATION,
    TRIALS,
    per_network,
    taught,
    taught_trials,
)

OWN_ARMS = {"paper": CURRICULUM, "uniform": CONTROL}
"""Teachers that every experiment has, by the name of their stage."""


def training_stage(teacher: str, network: int) -> str:
    """Return the name of the stage in which a teacher trains a network."""
    return per_network(OWN_ARMS.get(teacher, taught(teacher)), network)


def test_stage(teacher: str, network: int) -> str:
    """Return the name of the stage that tests it."""
    own = OWN_ARMS.get(teacher)
    return per_network(taught_trials(teacher) if own is None else TRIALS[own], network)


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
    space = config.family.space(config.env)
    for name in names:
        require_fit(name, space)
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
            kind=kinds.TEACHER_STATISTICS,
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
    record = key_record(config)
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
        kind=kinds.TEACHER,
        config=part,
        seed=stage_seed(config, name),
        inputs={
            "network": (per_network(INITIATION, network),),
            "analysis": (ANALYSIS,),
            "curriculum": (per_network(CURRICULUM, network),),
        },
    )
    tested = test_stage(teacher, network)
    return [train, *trial_stages(config, tested, record["tests"], network, train.name)]


def _settings(teaching: TeachersConfig, teacher: str) -> dict[str, Any]:
    """Return a teacher's own settings; none of most."""
    return key_record(teaching)[SETTINGS[teacher]] if teacher in SETTINGS else {}
