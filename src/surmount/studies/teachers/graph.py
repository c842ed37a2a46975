"""The stages of a comparison of teachers, network by network."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from surmount.core.configuration import key_record
from surmount.experiment import kinds
from surmount.experiment.task_part import stage_seed, task_part
from surmount.experiment.trial_stages import trial_stages
from surmount.studies.teachers.learning import LEARN
from surmount.studies.teachers.plan import ORACLE, REFERENCE, TaskPlan
from surmount.studies.teachers.returns import RETURNS
from surmount.teachers.catalogue import SETTINGS, require_space
from surmount.workflow.graph import Stage
from surmount.workflow.run_layout import (
    ANALYSIS,
    INITIATION,
    TRIALS,
    per_network,
    taught,
    taught_trials,
)


def stage_name(plan: TaskPlan, kind: str, network: int) -> str:
    """Return the name of a stage of one task."""
    return f"{plan.label}/{per_network(kind, network)}"


def comparison_stages(plans: Sequence[TaskPlan], *, headroom_only: bool = False) -> list[Stage]:
    """Return all stages; those of one network stand together.

    A comparison that runs out of time then lacks whole networks, and no teacher more than another.
    Every network has an analysis of its own, so that networks are independent.

    Parameters
    ----------
    plans
        One per task.
    headroom_only
        Leave out all but the reference and the oracle, and all networks after the pilot.

    Raises
    ------
    ConfigError
        If a teacher cannot do with the axes of a task.
    """
    for plan in plans:
        space = plan.config.family.space(plan.config.env)
        for name in plan.teachers:
            require_space(name, space, plan.teaching)
    return [
        stage
        for plan in plans
        for network in range(plan.pilot if headroom_only else plan.networks)
        for stage in _network(plan, network, headroom_only=headroom_only)
    ]


def returns_of(teacher: str) -> str:
    """Return the kind of the stages that measure a teacher's networks on the target tasks."""
    return f"returns/{teacher}"


def arms(plan: TaskPlan, network: int, *, headroom_only: bool = False) -> tuple[str, ...]:
    """Return the teachers of a network; the oracle teaches those of the pilot alone."""
    teachers = (REFERENCE,) if headroom_only else plan.teachers
    return (*teachers, ORACLE) if network < plan.pilot else teachers


def _network(plan: TaskPlan, network: int, *, headroom_only: bool) -> Iterator[Stage]:
    config, record = plan.config, key_record(plan.config)
    train = task_part(config) | {key: record[key] for key in ("learner", "checkpoint_steps")}
    initial = stage_name(plan, INITIATION, network)
    yield Stage(
        name=initial,
        kind=kinds.INITIATION,
        config=train | {"initial_steps": record["initial_steps"]},
        seed=_seed(plan, INITIATION, network),
    )
    tried = stage_name(plan, TRIALS[INITIATION], network)
    yield from trial_stages(config, tried, record["trials"], network, initial)
    analysed = stage_name(plan, ANALYSIS, network)
    harder = config.analysis.harder or config.family.space(config.env).harder or ()
    yield Stage(
        name=analysed,
        kind=kinds.ANALYSIS,
        config={"analysis": record["analysis"] | {"harder": list(harder)}},
        seed=_seed(plan, ANALYSIS, network),
        inputs={"trials": (tried,)},
    )
    for teacher in arms(plan, network, headroom_only=headroom_only):
        learnt = stage_name(plan, taught(teacher), network)
        yield Stage(
            name=learnt,
            kind=LEARN,
            config=train
            | {key: record[key] for key in ("advancement", "analysis")}
            | {
                "teacher": teacher,
                "budget_steps": plan.budget_steps,
                "towards": plan.towards,
                "teaching": _settings(plan, teacher),
            },
            # One seed for all teachers of a network: pairs differ by what is taught alone.
            seed=_seed(plan, "teach", network),
            inputs={"network": (initial,), "trials": (tried,), "analysis": (analysed,)},
        )
        tested = stage_name(plan, taught_trials(teacher), network)
        yield from trial_stages(config, tested, record["tests"], network, learnt)
        if plan.towards == "target":
            yield Stage(
                name=stage_name(plan, returns_of(teacher), network),
                kind=RETURNS,
                config=task_part(config) | {"learner": record["learner"]},
                seed=_seed(plan, "returns", network),
                inputs={"network": (learnt,)},
            )


def _seed(plan: TaskPlan, kind: str, network: int) -> int:
    """Return a seed that does not depend on the setting: settings are compared in pairs too."""
    return stage_seed(plan.config, per_network(kind, network))


def _settings(plan: TaskPlan, teacher: str) -> dict[str, Any]:
    """Return a teacher's own settings; none of most."""
    field = SETTINGS.get(teacher)
    return {} if field is None else {field: key_record(plan.teaching)[field]}
