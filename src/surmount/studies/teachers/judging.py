"""What came of a comparison: scores of every network, tests against the reference, headroom.

All measures are fixed before the runs (docs/results/teachers/plan.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.seeds import derive_seed
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.detectable import detectable_between
from surmount.stats.differences import network_difference
from surmount.stats.evidence import (
    bootstrap_interval,
    difference_interval,
    probability_of_improvement,
)
from surmount.stats.holm import holm
from surmount.studies.teachers.graph import recipe
from surmount.studies.teachers.outcomes import NOTHING, Outcome, judged_variants
from surmount.studies.teachers.plan import ORACLE, REFERENCE, TaskPlan
from surmount.teachers.catalogue import find_teacher

LOOKS = 2
"""How often p values are looked at: where time runs out, and at the last planned network."""
LEVEL = 0.05 / LOOKS
"""Two-sided level of all tests, after Holm, at each look."""
MARGIN = 0.05
"""Loss of mean success that counts as no harm."""
HARD_SHARE = 0.25
"""Share of a network's worst variants that the mean over the worst is taken of."""

ABLATED, ABLATIONS = "frontier", ("frontier-cells", "frontier-parameters")
"""The teacher whose ideas are taken out one by one, and itself without each."""

Record = dict[str, Any]


def judge(plans: Sequence[TaskPlan], outcomes: Mapping[str, Outcome]) -> Record:
    """Return the record of a comparison, as far as it has got.

    Of each lot of teachers those networks are judged that all of the lot have; the record holds the
    others, too.

    Parameters
    ----------
    plans
        One per task.
    outcomes
        What their networks came to, by the task's label.
    """
    tasks = [_task(plan, outcomes.get(plan.label, NOTHING)) for plan in plans]
    _adjust(tasks)
    return {"kind": "comparison of teachers", "schema": 2, "tasks": tasks}


def worst(scores: FloatArray) -> FloatArray:
    """Return each network's mean success over its worst quarter of variants, ``(network,)``."""
    count = max(1, round(HARD_SHARE * scores.shape[1]))
    return np.sort(scores, axis=1)[:, :count].mean(axis=1)


def against(first: FloatArray, second: FloatArray, seed: int) -> Record:
    """Compare a teacher with the reference over networks that both have.

    Parameters
    ----------
    first, second
        Success of both, ``(network, variant)``, pair by pair.
    seed
        Of the bootstrap.
    """
    bootstrap = Bootstrap(seed=seed)
    differences = (first - second).mean(axis=1)
    mean = network_difference(first, second, paired=True)
    sd = float(differences.std(ddof=1)) if differences.size > 1 else 0.0
    return {
        "networks": int(differences.size),
        "mean": difference_interval(
            first, second, bootstrap, paired=True, statistic=_mean
        ).to_record(),
        "t": mean.to_record(),
        "interquartile_mean": difference_interval(
            first, second, bootstrap, paired=True
        ).to_record(),
        "worst": float((worst(first) - worst(second)).mean()),
        "probability_of_improvement": probability_of_improvement(
            first, second, bootstrap, paired=True
        ).to_record(),
        "wilcoxon_p": _wilcoxon(differences),
        "sd": sd,
        "smallest_detectable": detectable_between(differences),
    }


def _task(plan: TaskPlan, outcome: Outcome) -> Record:
    seed = derive_seed(plan.config.seed, "judging", plan.label)
    judged = {name: outcome.whole(lot) for lot in plan.lots for name in lot}
    reference = outcome.arm(REFERENCE).success
    # Of the headroom alone no lot is whole: the reference is then told by itself.
    judged[REFERENCE] = sorted({network for own in judged.values() for network in own} or reference)
    found = {
        name: {network: outcome.arm(name).success[network] for network in judged[name]}
        for name in plan.teachers
    }
    space = plan.config.family.space(plan.config.env)
    return {
        "name": plan.label,
        "title": plan.config.family.title + ("" if plan.towards == "range" else ", target tasks"),
        "role": plan.role,
        "planned": {
            "networks": plan.networks,
            "pilot": plan.pilot,
            "budget_steps": plan.budget_steps,
        },
        "parameters": list(space.parameters),
        "variants": space.variants[judged_variants(plan)].tolist(),
        **outcome.initial_record(),
        "oracle": _arm_record(plan, outcome, ORACLE),
        "headroom": _against(outcome.arm(ORACLE).success, reference, seed),
        "ablations": {
            name: _against(found[ABLATED], found[name], seed)
            for name in ABLATIONS
            if name in found and ABLATED in found
        },
        "teachers": [
            {
                "name": name,
                "title": find_teacher(name).title,
                **_arm_record(plan, outcome, name),
                "published_returns": _published(plan, name),
                "pays_for_trials": find_teacher(name).by_trials,
                "judged": judged[name],
                "summary": _summary(found[name], seed),
                "below_initial": _below(found[name], outcome.initial.success),
                "against": None if name == REFERENCE else _against(found[name], reference, seed),
            }
            for name in plan.teachers
        ],
    }


def _arm_record(plan: TaskPlan, outcome: Outcome, teacher: str) -> Record:
    return {"recipe": recipe(plan, teacher), **outcome.arm(teacher).to_record()}


def _published(plan: TaskPlan, teacher: str) -> list[float] | None:
    """Return between what returns the authors' own runs end, where the targets are asked for."""
    published = plan.config.family.published_returns().get(teacher)
    return None if published is None or plan.towards == "range" else list(published)


def _below(scores: Mapping[int, FloatArray], initial: Mapping[int, FloatArray]) -> int:
    """Count the networks that end below their initial network."""
    return sum(
        bool(rates.mean() < initial[network].mean())
        for network, rates in scores.items()
        if network in initial
    )


def _summary(scores: Mapping[int, FloatArray], seed: int) -> Record | None:
    if not scores:
        return None
    matrix = np.stack(list(scores.values()))
    bootstrap = Bootstrap(seed=seed)
    return {
        "networks": len(scores),
        "mean": bootstrap_interval(matrix, bootstrap, statistic=_mean).to_record(),
        "interquartile_mean": bootstrap_interval(matrix, bootstrap).to_record(),
        "worst": float(worst(matrix).mean()),
    }


def _against(
    first: Mapping[int, FloatArray], second: Mapping[int, FloatArray], seed: int
) -> Record | None:
    shared = sorted(first.keys() & second.keys())
    if len(shared) < 2:
        return None
    one, two = (np.stack([arm[network] for network in shared]) for arm in (first, second))
    return against(one, two, seed)


def _wilcoxon(differences: FloatArray) -> float:
    """Return the two-sided p value of Wilcoxon's signed ranks; 1 where no pair differs."""
    from scipy.stats import wilcoxon  # noqa: PLC0415 - slow to import

    if not (np.abs(differences) > 0).any():
        return 1.0
    found: Any = wilcoxon(differences)
    return float(found.pvalue)


def _adjust(tasks: Sequence[Record]) -> None:
    """Add Holm's p values over all comparisons on the held-out tasks that have headroom.

    Those with the reference are one family, those of the ablations another.
    """
    counted = [task for task in tasks if task["role"] == "held out" and has_headroom(task)]
    families = (
        [teacher["against"] for task in counted for teacher in task["teachers"]],
        [found for task in counted for found in task["ablations"].values()],
    )
    for family in families:
        compared = [one for one in family if one is not None]
        adjusted = holm([one["wilcoxon_p"] for one in compared]).tolist()
        for one, p in zip(compared, adjusted, strict=True):
            one["holm_p"] = p


def has_headroom(task: Mapping[str, Any]) -> bool:
    """Return whether the oracle beats the reference: its interval lies above zero."""
    found = task["headroom"]
    lower = None if found is None else found["mean"]["lower"]
    return lower is not None and lower > 0


def _mean(values: FloatArray) -> float:
    return float(values.mean())
