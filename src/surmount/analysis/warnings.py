"""Sentences on what a reader must know before trusting an analysis."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Mapping
from typing import Any, cast

import numpy as np
from scipy.stats import fisher_exact

from surmount.analysis.cut import may_divide
from surmount.analysis.description import describe_variants
from surmount.analysis.result import Analysis
from surmount.analysis.trust import hanging, unstable_parts

_FEW_TRIALS = 10
_SHOWN = 5
"""Features that a warning names."""
_TOLD_APART = 0.05
"""Probability below which the success rates of two groups are told apart."""


def analysis_warnings(analysis: Analysis, *, outliers: Mapping[str, float]) -> Analysis:
    """Return the analysis with its warnings filled in.

    Parameters
    ----------
    analysis
        All evidence.
    outliers
        Single values that outweigh all others of their feature, by feature.
    """
    found = [
        *_about_data(analysis),
        *_about_outliers(analysis, outliers),
        *_about_features(analysis),
        *_about_fits(analysis),
        *_about_groups(analysis),
        *_about_order(analysis),
        *_about_stability(analysis),
    ]
    return dataclasses.replace(analysis, warnings=tuple(found))


def _about_data(analysis: Analysis) -> list[str]:
    found: list[str] = list(analysis.notes)
    if analysis.features.dropped:
        found.append(
            "Left out because they never change, or by rounding only: "
            f"{', '.join(analysis.features.dropped)}."
        )
    if analysis.n_networks == 1:
        found.append(
            "All trials are of one network: whether another training run behaves alike is unknown."
        )
    few = np.flatnonzero(analysis.n_trials < _FEW_TRIALS)
    if few.size:
        names = ", ".join(analysis.label(i) for i in few)
        found.append(
            f"Fewer than {_FEW_TRIALS} trials on {few.size} of {analysis.variants.shape[0]} "
            f"variants ({names}): their success rates are rough."
        )
    return found


def _about_outliers(analysis: Analysis, outliers: Mapping[str, float]) -> list[str]:
    used = {name: value for name, value in outliers.items() if name in analysis.features.logged}
    if not used:
        return []
    shown = ", ".join(f"`{name}` (one is {value:g})" for name, value in [*used.items()][:_SHOWN])
    more = f" and {len(used) - _SHOWN} more features" if len(used) > _SHOWN else ""
    warning = (
        f"One value is farther from the mean than all others together in {shown}{more}: beside it, "
        "the others hardly differ, and the feature says next to nothing. Drop that trial, or leave "
        "the feature out with `features`."
    )
    return [warning]


_SUSPECTED = {
    "clock": "rises over the whole table from trial to trial, as a clock or a counter does",
    "network-clock": "rises within each network from trial to trial, as a clock or a counter does "
    "that begins anew for each",
    "task": "has a single value on each variant, as the task itself has",
}


def _about_features(analysis: Analysis) -> list[str]:
    """Warn of features that may not be behaviour, and of those that decide alone."""
    found: list[str] = []
    hung_on = hanging(analysis)
    for one in analysis.suspects:
        hang = f", and the groups hang on it ({_groups(one.n_groups)} without it)"
        found.append(
            f"`{one.feature}` {_SUSPECTED[one.kind]}{hang if one.feature in hung_on else ''}. If "
            "it is no behaviour, leave it out (name the others with `features`)."
        )
    suspected = {one.feature for one in analysis.suspects}
    found += [
        f"Without `{name}` all variants are one group: the groups stand on this one feature."
        for name in hung_on
        if name not in suspected
    ]
    return found


def _groups(count: int) -> str:
    return "one group" if count == 1 else f"{count} groups"


def _about_fits(analysis: Analysis) -> list[str]:
    found: list[str] = []
    if analysis.not_converged:
        found.append(
            f"{analysis.not_converged} of {len(analysis.mixtures)} mixtures did not converge "
            f"within {analysis.config.max_iterations} iterations; raise `max_iterations`."
        )
    fits = [mixture.fit for mixture in analysis.mixtures if mixture.fit]
    wanted = max(fit.requested for fit in fits)
    fewer = sum(fit.requested < wanted for fit in fits)
    if fewer and not analysis.config.components_per_variant:
        found.append(
            f"Not every variant has enough samples for {wanted} components: {fewer} got fewer."
        )
    if analysis.collapsed:
        found.append(
            f"Components collapsed and were removed ({analysis.collapsed} in all): each had come "
            "to describe fewer samples than a covariance needs "
            f"({len(analysis.features.names) + 1})."
        )
    curve = analysis.bic
    if curve and curve.minimum == curve.components[-1] == analysis.config.max_components:
        found.append(
            f"The BIC still falls at the end of its range (K = {curve.components[-1]}): more "
            "components would fit better; raise `max_components` to see."
        )
    return found


def _about_groups(analysis: Analysis) -> list[str]:
    found: list[str] = []
    if len(analysis.groups) == 1 and analysis.merges:
        small = "; ".join(
            describe_variants(analysis.variants[list(merge.members)], analysis.axes)
            for merge in analysis.merges
        )
        found.append(
            f"Behaviour changes abruptly, but only around groups of at most "
            f"{analysis.merges[0].limit} variants ({small}), which were merged: all variants form "
            "one group. Lower `small_group_size` to keep them, or record variants in between."
        )
    elif len(analysis.groups) == 1 and not may_divide(analysis.cut):
        found.append(
            f"{len(analysis.variants)} variants cannot be cut by the rule `{analysis.cut.method}`: "
            "it compares links with each other, and there are too few. They form one group, "
            "whatever the behaviour; record more variants."
        )
    elif len(analysis.groups) == 1:
        found.append("No abrupt change of behaviour was found: all variants form one group.")
    if not analysis.curriculum.levels:
        found.append(
            "Every group already reaches the success threshold of "
            f"{analysis.curriculum.success_threshold:.0%}: the curriculum has no levels."
        )
    return found


def _about_order(analysis: Analysis) -> list[str]:
    """Warn where the trials do not tell which of two neighbours in rank succeeds more often."""
    threshold = analysis.curriculum.success_threshold
    found: list[str] = []
    for rank, (easier, harder) in enumerate(itertools.pairwise(analysis.groups)):
        if harder.success_rate >= threshold:
            continue  # neither has a level
        (one, of_one), (other, of_other) = (_trials_won(analysis, rank + i) for i in (0, 1))
        if one == other == 0:
            found.append(
                f"No trial succeeded in the groups {easier.name} and {harder.name}: they are "
                "ranked in the order of their variants, and whether one is easier is unknown."
            )
            continue
        table = [[one, of_one - one], [other, of_other - other]]
        p_value = float(cast(Any, fisher_exact(table)).pvalue)
        if p_value >= _TOLD_APART:
            found.append(
                f"Whether the group {easier.name} is easier than {harder.name} is not sure: "
                f"{one} of {of_one} and {other} of {of_other} trials succeeded, which chance "
                f"alone may give (Fisher's exact test, p = {p_value:.2f}). Record more trials, or "
                "order the levels by hand."
            )
    return found


def _trials_won(analysis: Analysis, group: int) -> tuple[int, int]:
    own = analysis.labels == group
    return int(analysis.trials_won[own].sum()), int(analysis.n_trials[own].sum())


def _about_stability(analysis: Analysis) -> list[str]:
    if analysis.stability is None:
        return ["The stability of the grouping was not assessed (`bootstrap` is 0)."]
    return unstable_parts(analysis, analysis.stability)
