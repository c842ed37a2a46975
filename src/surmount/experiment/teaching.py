"""The graph of a comparison of teachers at matched budgets.

A comparison is an experiment with more arms. The paper's curriculum and the uniform control are the
experiment's own; every other teacher trains each of its initial networks for as many steps as the
paper's curriculum took with that network, and is tested alike. So a finished experiment is taken
as it is, and teachers can be added one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from surmount.core.configuration import from_record, key_record, to_record
from surmount.core.errors import ConfigError
from surmount.core.records import read_record
from surmount.experiment import kinds
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.protocol import protocol
from surmount.experiment.task_part import stage_seed, task_part
from surmount.experiment.trial_stages import trial_stages
from surmount.learn.choice import estimates_values
from surmount.teachers.catalogue import (
    SETTINGS,
    TEACHERS,
    TeachersConfig,
    find_teacher,
    require_space,
)
from surmount.workflow.graph import Stage
from surmount.workflow.run_folder import open_run
from surmount.workflow.run_layout import (
    ANALYSIS,
    COMPARISON,
    COMPARISON_FILE,
    CONTROL,
    CURRICULUM,
    INITIATION,
    RUN,
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
        require_space(name, space, teaching)
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


def require_fit(config: ExperimentConfig, teachers: Sequence[str]) -> None:
    """Refuse teachers that need a critic where the learner is known to have none.

    Raises
    ------
    ConfigError
        If a teacher is unknown or does not fit, before anything is trained.
    """
    without = estimates_values(config.learner) is False
    for name in teachers:
        if find_teacher(name).needs_value_errors and without:
            raise ConfigError(
                f"The teacher `{name}` needs a critic's value errors, and "
                f"{config.learner.algorithm} estimates none.",
                remedy="Leave the teacher out, or learn by PPO, A2C or another algorithm with "
                "roll-outs.",
            )


def with_earlier(
    folder: Path, teachers: Sequence[str], teaching: TeachersConfig
) -> tuple[tuple[str, ...], TeachersConfig]:
    """Return teachers and settings together with those that a folder's comparison has already.

    Parameters
    ----------
    folder
        Of a run, if there is one.
    teachers, teaching
        What is asked for now; it wins over what was.
    """
    if not (folder / RUN).is_file():
        return tuple(teachers), teaching
    found = open_run(folder).stages.get(COMPARISON)
    if found is None:
        return tuple(teachers), teaching
    kept: dict[str, Any] = {
        str(one["name"]): one["settings"]
        for one in read_record(found.path(COMPARISON_FILE))["teachers"]
        if one["name"] in TEACHERS and one["name"] not in (*teachers, *OWN_ARMS)
    }
    record = to_record(teaching)
    for name, settings in kept.items():
        if name in SETTINGS:
            record[SETTINGS[name]] = settings
    return (*teachers, *kept), from_record(TeachersConfig, record)


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
