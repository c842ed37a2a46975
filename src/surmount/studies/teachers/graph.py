"""The stages of a comparison of teachers, network by network."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from surmount.core.configuration import key_record
from surmount.core.records import record_hash
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


def comparison_stages(
    plans: Sequence[TaskPlan],
    *,
    headroom_only: bool = False,
    known: Callable[[TaskPlan, str, int], bool] = lambda *_: False,
) -> list[Stage]:
    """Return all stages; those of one network stand together, lot of teachers by lot.

    A comparison that runs out of time then lacks whole networks, and no teacher of a lot more than
    another. Every network has an analysis of its own, so that networks are independent.

    Parameters
    ----------
    plans
        One per task.
    headroom_only
        Leave out all but the reference and the oracle, and all networks after the pilot.
    known
        Whether a teacher's network is measured already, and needs no stages; of task, teacher and
        network.

    Raises
    ------
    ConfigError
        If a teacher cannot do with the axes of a task.
    """
    for plan in plans:
        space = plan.config.family.space(plan.config.env)
        for name in plan.teachers:
            require_space(name, space, plan.teaching)
    stages: dict[str, Stage] = {}
    for plan in plans:
        for network, teacher in arms(plan, headroom_only=headroom_only):
            if not known(plan, teacher, network):
                for stage in (*_initial(plan, network), *_taught(plan, teacher, network)):
                    stages[stage.name] = stage
    return list(stages.values())


def arms(plan: TaskPlan, *, headroom_only: bool = False) -> Iterator[tuple[int, str]]:
    """Yield networks and their teachers in the order they run; the oracle has the pilot's alone."""
    for lot in plan.lots[:1] if headroom_only else plan.lots:
        for network in range(plan.pilot if headroom_only else plan.networks):
            first = lot is plan.lots[0]
            for teacher in (REFERENCE,) if headroom_only else lot:
                yield network, teacher
            if first and network < plan.pilot:
                yield network, ORACLE


def returns_of(teacher: str) -> str:
    """Return the kind of the stages that measure a teacher's networks on the target tasks."""
    return f"returns/{teacher}"


def recipe(plan: TaskPlan, teacher: str) -> str:
    """Return a hash of all that a teacher's networks are trained and tested by, but roundings.

    It is the same on every machine, where keys of stages hold what their inputs came to.
    """
    stages = (*_initial(plan, 0), *_taught(plan, teacher, 0))
    return record_hash(
        [
            {
                "kind": stage.kind.name,
                "version": stage.kind.version,
                "config": stage.config,
                "seed": stage.seed,
            }
            for stage in stages
        ]
    )


def _initial(plan: TaskPlan, network: int) -> Iterator[Stage]:
    """Yield what all teachers of a network share: initiation, trials and analysis."""
    config, record = plan.config, key_record(plan.config)
    initial = stage_name(plan, INITIATION, network)
    yield Stage(
        name=initial,
        kind=kinds.INITIATION,
        config=_training(plan) | {"initial_steps": record["initial_steps"]},
        seed=_seed(plan, INITIATION, network),
    )
    tried = stage_name(plan, TRIALS[INITIATION], network)
    yield from trial_stages(config, tried, record["trials"], network, initial)
    harder = config.analysis.harder or config.family.space(config.env).harder or ()
    yield Stage(
        name=stage_name(plan, ANALYSIS, network),
        kind=kinds.ANALYSIS,
        config={"analysis": record["analysis"] | {"harder": list(harder)}},
        seed=_seed(plan, ANALYSIS, network),
        inputs={"trials": (tried,)},
    )


def _taught(plan: TaskPlan, teacher: str, network: int) -> Iterator[Stage]:
    """Yield what one teacher makes of a network: training and tests."""
    config, record = plan.config, key_record(plan.config)
    learnt = stage_name(plan, taught(teacher), network)
    yield Stage(
        name=learnt,
        kind=LEARN,
        config=_training(plan)
        | {key: record[key] for key in ("advancement", "analysis")}
        | {
            "teacher": teacher,
            "budget_steps": plan.budget_steps,
            "towards": plan.towards,
            "teaching": _settings(plan, teacher),
        },
        # One seed for all teachers of a network: pairs differ by what is taught alone.
        seed=_seed(plan, "teach", network),
        inputs={
            "network": (stage_name(plan, INITIATION, network),),
            "trials": (stage_name(plan, TRIALS[INITIATION], network),),
            "analysis": (stage_name(plan, ANALYSIS, network),),
        },
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


def _training(plan: TaskPlan) -> dict[str, Any]:
    record = key_record(plan.config)
    return task_part(plan.config) | {key: record[key] for key in ("learner", "checkpoint_steps")}


def _seed(plan: TaskPlan, kind: str, network: int) -> int:
    """Return a seed that does not depend on the setting: settings are compared in pairs too."""
    return stage_seed(plan.config, per_network(kind, network))


def _settings(plan: TaskPlan, teacher: str) -> dict[str, Any]:
    """Return a teacher's own settings; none of most."""
    field = SETTINGS.get(teacher)
    return {} if field is None else {field: key_record(plan.teaching)[field]}
