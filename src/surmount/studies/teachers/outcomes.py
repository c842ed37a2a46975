"""What the networks of a comparison came to: from finished stages, or measured elsewhere before."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.errors import InputError
from surmount.core.reading import read_as
from surmount.core.records import read_record
from surmount.experiment.stages import pooled_trials
from surmount.experiment.statistics import success_matrix
from surmount.studies.teachers.graph import recipe, returns_of, stage_name
from surmount.studies.teachers.learning import steps_of
from surmount.studies.teachers.plan import ORACLE, REFERENCE, TaskPlan
from surmount.studies.teachers.returns import mean_return
from surmount.workflow.run_layout import INITIATION, TRIALS, taught_trials
from surmount.workflow.store import Artefact

Record = dict[str, Any]
Value = TypeVar("Value")


@dataclass(frozen=True, kw_only=True)
class Arm:
    """What the networks of one teacher came to, each under its index.

    Attributes
    ----------
    success
        Share of successes on every variant that counts, ``(variant,)``.
    returns
        Mean discounted return on the target tasks; empty where these are not asked for.
    elsewhere
        Networks that were taken over from another folder's record.
    """

    success: Mapping[int, FloatArray] = field(default_factory=dict[int, FloatArray])
    returns: Mapping[int, float] = field(default_factory=dict[int, float])
    elsewhere: frozenset[int] = frozenset()

    def with_earlier(self, earlier: Arm) -> Arm:
        """Return the same with networks that were measured before, where it has none."""
        return Arm(
            success=_in_order({**earlier.success, **self.success}),
            returns=_in_order({**earlier.returns, **self.returns}),
            elsewhere=frozenset(earlier.success.keys() - self.success.keys()),
        )

    def to_record(self) -> Record:
        """Return the JSON form."""
        return {
            "success": {str(network): rates.tolist() for network, rates in self.success.items()},
            "returns": {str(network): value for network, value in self.returns.items()},
            "elsewhere": sorted(self.elsewhere),
        }


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What the networks of one task came to.

    Attributes
    ----------
    arms
        By teacher, the oracle's among them.
    initial
        Of the networks that all teachers go on from.
    trial_steps
        Steps of each network's trials, which teachers with groups pay for.
    """

    arms: Mapping[str, Arm]
    initial: Arm = field(default_factory=Arm)
    trial_steps: Mapping[int, int] = field(default_factory=dict[int, int])

    def arm(self, teacher: str) -> Arm:
        """Return a teacher's arm, empty if it has none."""
        return self.arms.get(teacher, Arm())

    def has(self, teacher: str, network: int) -> bool:
        """Return whether a teacher's network was measured."""
        return network in self.arm(teacher).success

    def whole(self, teachers: tuple[str, ...]) -> list[int]:
        """Return the networks that the reference and all of some teachers have."""
        first, *others = (set(self.arm(name).success) for name in (REFERENCE, *teachers))
        return sorted(first.intersection(*others))

    def initial_record(self) -> Record:
        """Return the JSON form of what all teachers go on from."""
        return {
            "initial": self.initial.to_record()["success"],
            "trial_steps": {str(network): steps for network, steps in self.trial_steps.items()},
        }

    def with_earlier(self, earlier: Outcome) -> Outcome:
        """Return the same with networks that were measured before, where it has none."""
        names = dict.fromkeys([*self.arms, *earlier.arms])
        return Outcome(
            arms={name: self.arm(name).with_earlier(earlier.arm(name)) for name in names},
            initial=self.initial.with_earlier(earlier.initial),
            trial_steps=_in_order({**earlier.trial_steps, **self.trial_steps}),
        )


NOTHING = Outcome(arms={})


def measured(plan: TaskPlan, artefacts: Mapping[str, Artefact]) -> Outcome:
    """Return what finished stages, by name, came to."""
    counts = judged_variants(plan)
    tried = _found(plan, TRIALS[INITIATION], artefacts)
    trials = {network: pooled_trials((artefact,)) for network, artefact in tried.items()}
    return Outcome(
        arms={
            name: Arm(
                success={
                    network: success_matrix(pooled_trials((artefact,)))[0][counts]
                    for network, artefact in _found(plan, taught_trials(name), artefacts).items()
                },
                returns={
                    network: mean_return(artefact)
                    for network, artefact in _found(plan, returns_of(name), artefacts).items()
                },
            )
            for name in (*plan.teachers, ORACLE)
        },
        initial=Arm(
            success={network: success_matrix(one)[0][counts] for network, one in trials.items()}
        ),
        trial_steps={network: steps_of(one) for network, one in trials.items()},
    )


def judged_variants(plan: TaskPlan) -> BoolArray:
    """Return which variants count: all, or those among the target tasks; ``(variant,)``."""
    family = plan.config.family
    variants = family.space(plan.config.env).variants
    target = family.target(plan.config.env) if plan.towards == "target" else None
    if target is None:
        return np.ones(len(variants), dtype=np.bool_)
    lower, upper = target.lower[:, None], target.upper[:, None]
    inside = ((lower <= variants) & (variants <= upper)).all(axis=2).any(axis=0)
    return np.asarray(inside, dtype=np.bool_)


@dataclass(frozen=True, kw_only=True)
class _ArmRecord:
    recipe: str
    success: dict[str, list[float]]
    returns: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class _TeacherRecord(_ArmRecord):
    name: str


@dataclass(frozen=True, kw_only=True)
class _TaskRecord:
    name: str
    initial: dict[str, list[float]]
    trial_steps: dict[str, int]
    oracle: _ArmRecord
    teachers: list[_TeacherRecord]


def read_earlier(path: Path, plans: tuple[TaskPlan, ...]) -> tuple[dict[str, Outcome], list[str]]:
    """Read the networks that a comparison has measured before, perhaps on another machine.

    Only what was trained and tested by the same settings, budgets and seeds is taken over.

    Parameters
    ----------
    path
        Its ``comparison.json``.
    plans
        What is wanted now.

    Returns
    -------
    outcomes
        By the task's label, of every task.
    others
        A sentence for each teacher whose networks were measured in another way.

    Raises
    ------
    InputError
        If the file does not hold a comparison of this version.
    """
    try:
        tasks = read_as(list[_TaskRecord], read_record(path).get("tasks"))
    except ValueError as error:
        raise InputError(
            f"{path} does not hold the networks of a comparison of teachers ({error}).",
            remedy="Give the comparison.json that `surmount teachers` of this version wrote.",
        ) from error
    found = {plan.label: NOTHING for plan in plans}
    others: list[str] = []
    for plan in plans:
        for task in tasks:
            if task.name == plan.label:
                found[plan.label], refused = _of_plan(task, plan)
                others += [
                    f"{plan.label}: the networks of `{name}` in {path} were trained or tested by "
                    "other settings; they are run again."
                    for name in refused
                ]
    return found, others


def _of_plan(task: _TaskRecord, plan: TaskPlan) -> tuple[Outcome, list[str]]:
    arms: dict[str, _ArmRecord] = {one.name: one for one in task.teachers} | {ORACLE: task.oracle}
    held = {name: arm for name, arm in arms.items() if arm.success}
    wanted = [name for name in (*plan.teachers, ORACLE) if name in held]
    fitting = [name for name in wanted if held[name].recipe == recipe(plan, name)]
    if not fitting:
        return NOTHING, wanted
    taken = Outcome(
        arms={name: _arm(held[name].success, held[name].returns) for name in fitting},
        initial=_arm(task.initial, {}),
        trial_steps={int(network): steps for network, steps in task.trial_steps.items()},
    )
    return taken, [name for name in wanted if name not in fitting]


def _arm(success: Mapping[str, list[float]], returns: Mapping[str, float]) -> Arm:
    return Arm(
        success={int(network): np.asarray(rates) for network, rates in success.items()},
        returns={int(network): value for network, value in returns.items()},
    )


def _found(plan: TaskPlan, kind: str, artefacts: Mapping[str, Artefact]) -> dict[int, Artefact]:
    names = {network: stage_name(plan, kind, network) for network in range(plan.networks)}
    return {network: artefacts[name] for network, name in names.items() if name in artefacts}


def _in_order(by_network: Mapping[int, Value]) -> dict[int, Value]:
    return dict(sorted(by_network.items()))
