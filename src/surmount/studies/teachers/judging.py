"""What came of a comparison: scores of every network, tests against the reference, headroom.

All measures are fixed before the runs (docs/results/teachers/plan.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.seeds import derive_seed
from surmount.experiment.stages import pooled_trials
from surmount.experiment.statistics import success_matrix
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.detectable import detectable_between
from surmount.stats.differences import network_difference
from surmount.stats.evidence import (
    bootstrap_interval,
    difference_interval,
    probability_of_improvement,
)
from surmount.stats.holm import holm
from surmount.studies.teachers.graph import returns_of, stage_name
from surmount.studies.teachers.plan import ORACLE, REFERENCE, TaskPlan
from surmount.studies.teachers.returns import mean_returns
from surmount.teachers.catalogue import find_teacher
from surmount.workflow.run_layout import INITIATION, TRIALS, taught_trials
from surmount.workflow.store import Artefact

LEVEL = 0.05
"""Two-sided level of all tests, after Holm."""
MARGIN = 0.05
"""Loss of mean success that counts as no harm."""
HARD_SHARE = 0.25
"""Share of a network's worst variants that the mean over the worst is taken of."""

ABLATED, ABLATIONS = "frontier", ("frontier-cells", "frontier-parameters")
"""The teacher whose ideas are taken out one by one, and itself without each."""

Record = dict[str, Any]


def judge(plans: Sequence[TaskPlan], artefacts: Mapping[str, Artefact]) -> Record:
    """Return the record of a comparison, as far as it has got.

    Parameters
    ----------
    plans
        One per task.
    artefacts
        Finished stages by name.
    """
    tasks = [_task(plan, artefacts) for plan in plans]
    _adjust(tasks)
    return {"kind": "comparison of teachers", "schema": 1, "tasks": tasks}


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


def _task(plan: TaskPlan, artefacts: Mapping[str, Artefact]) -> Record:
    seed = derive_seed(plan.config.seed, "judging", plan.label)
    names = (*plan.teachers, ORACLE)
    found = {name: _scores(plan, taught_trials(name), artefacts) for name in names}
    reference = found[REFERENCE]
    initial = _scores(plan, TRIALS[INITIATION], artefacts)
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
        "initial": _listed(initial),
        "headroom": _against(found[ORACLE], reference, seed),
        "ablations": {
            name: _against(found[ABLATED], found[name], seed)
            for name in ABLATIONS
            if name in found and ABLATED in found
        },
        "teachers": [
            {
                "name": name,
                "title": find_teacher(name).title,
                "success": _listed(found[name]),
                "summary": _summary(found[name], seed),
                "below_initial": _below(found[name], initial),
                "returns": _returns(plan, name, artefacts),
                "against": None if name == REFERENCE else _against(found[name], reference, seed),
            }
            for name in plan.teachers
        ],
    }


def _returns(plan: TaskPlan, teacher: str, artefacts: Mapping[str, Artefact]) -> Record | None:
    """Return what each network ended at on the target tasks, beside what was published."""
    names = [stage_name(plan, returns_of(teacher), network) for network in range(plan.networks)]
    found = mean_returns(names, artefacts)
    published = plan.config.family.published_returns().get(teacher)
    if not found:
        return None
    return {"networks": found, "published": None if published is None else list(published)}


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


def _scores(plan: TaskPlan, kind: str, artefacts: Mapping[str, Artefact]) -> dict[int, FloatArray]:
    """Return the success of each finished network on every variant that counts."""
    counts = judged_variants(plan)
    names = {network: stage_name(plan, kind, network) for network in range(plan.networks)}
    return {
        network: success_matrix(pooled_trials((artefacts[name],)))[0][counts]
        for network, name in names.items()
        if name in artefacts
    }


def _below(scores: Mapping[int, FloatArray], initial: Mapping[int, FloatArray]) -> int:
    """Count the networks that end below their initial network."""
    return sum(
        bool(rates.mean() < initial[network].mean())
        for network, rates in scores.items()
        if network in initial
    )


def _listed(scores: Mapping[int, FloatArray]) -> dict[str, list[float]]:
    return {str(network): rates.tolist() for network, rates in scores.items()}


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
