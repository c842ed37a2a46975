"""How far a grouping can be trusted, in a few sentences with their numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surmount.analysis.description import counted
from surmount.analysis.features import describe_variant
from surmount.analysis.result import Analysis
from surmount.analysis.sensitivity import NETWORKS, deciding_features
from surmount.analysis.stability import Stability
from surmount.core.arrays import FloatArray

_MANY_NETWORKS = 10
"""Networks from which a bootstrap over them keeps its level (see surmount.stats.bootstrap)."""
_LIKE_ANOTHER = 0.5
"""Adjusted Rand index below which a grouping is another one."""
_SAME = 1.0 - 1e-9
"""Adjusted Rand index from which two groupings are the same."""


def describe_trust(analysis: Analysis) -> list[str]:
    """Return the verdict and what it rests on: bootstrap, sensitivity, networks."""
    return [
        _verdict(analysis),
        *_about_bootstrap(analysis),
        *_about_choices(analysis),
        *_about_networks(analysis),
    ]


def is_stable(analysis: Analysis) -> bool | None:
    """Return whether number, members and boundaries of the groups come back often enough.

    Groups that hang on one feature are not called stable, however often they come back: the
    feature may be a clock, and its values would come back as well. "Often enough" is
    ``stability_threshold`` of the bootstrap replicates; ``None`` where there was no bootstrap.
    """
    if analysis.stability is None:
        return None
    return not unstable_parts(analysis, analysis.stability) and not hanging(analysis)


def hanging(analysis: Analysis) -> tuple[str, ...]:
    """Return the features that the groups hang on; empty where they hold without each of them.

    These are clocks, counters and the task itself, where the groups without all of them are
    others, and features without which alone all variants are one group.
    """
    if len(analysis.groups) < 2:
        return ()
    doubtful = [one.feature for one in analysis.suspects if one.agreement < _LIKE_ANOTHER]
    alone = deciding_features(analysis.sensitivity, len(analysis.groups))
    return tuple(dict.fromkeys([*doubtful, *alone]))


def unstable_parts(analysis: Analysis, stability: Stability) -> list[str]:
    """Return a sentence on everything about the groups that too few replicates confirm."""
    threshold, labels = analysis.config.stability_threshold, analysis.labels
    replicates = f"{stability.replicates} replicates"
    found: list[str] = []
    if stability.same_count < threshold:
        listed = ", ".join(f"{count} in {share:.0%}" for count, share in stability.group_counts)
        found.append(
            f"The number of groups is not stable: with trials drawn again it was {listed} of "
            f"{replicates}."
        )
    if analysis.variants.shape[1] == 1:
        for left in np.flatnonzero(np.diff(labels) != 0):
            share = stability.boundaries[left]
            if share < threshold:
                low, high = (describe_variant(analysis.variants[i]) for i in (left, left + 1))
                found.append(
                    f"The boundary between {low} and {high} is not stable: it appeared in "
                    f"{share:.0%} of {replicates}."
                )
    for group, together, apart in zip(
        analysis.groups, stability.together(labels), stability.apart(labels), strict=True
    ):
        if together < threshold:
            found.append(
                f"The group {group.name} does not hold together: two of its variants shared a "
                f"group in {together:.0%} of {replicates}."
            )
        if apart < threshold:
            found.append(
                f"The group {group.name} is not held apart: a variant of it and one of another "
                f"group were in different groups in {apart:.0%} of {replicates}."
            )
    return found


def _verdict(analysis: Analysis) -> str:
    stable = is_stable(analysis)
    if stable is None:
        return "How stable the grouping is was not assessed (`bootstrap` is 0)."
    if stable:
        return "The grouping is stable under new draws of these networks and trials."
    features = hanging(analysis)
    if features and analysis.stability and not unstable_parts(analysis, analysis.stability):
        return (
            f"The groups hang on {_names(features)}: {_without(analysis, features)}. With it they "
            "come back under new draws of these networks and trials; whether they are groups of "
            "behaviour depends on whether it is one."
        )
    return (
        "The grouping is NOT stable: other trials of the same networks would give other groups. "
        "Record more trials or networks, or take the groups as a suggestion to be checked."
    )


def _names(features: Sequence[str]) -> str:
    listed = " and ".join(f"`{name}`" for name in features)
    return f"{listed} alone" if len(features) == 1 else listed


def _without(analysis: Analysis, features: Sequence[str]) -> str:
    counts = {one.feature: one.n_groups for one in analysis.suspects}
    n_groups = min(counts.get(name, 1) for name in features)
    return f"without {'it' if len(features) == 1 else 'each of them'} there is " + (
        "one group" if n_groups == 1 else f"another grouping, of {n_groups} groups"
    )


def _about_bootstrap(analysis: Analysis) -> list[str]:
    stability = analysis.stability
    if stability is None:
        return []
    counts = ", ".join(f"{count} in {share:.0%}" for count, share in stability.group_counts)
    together, apart = stability.together(analysis.labels), stability.apart(analysis.labels)
    sentences = [
        (
            f"With networks and trials drawn again {stability.replicates} times, the number of "
            f"groups was {counts}; {stability.agreement:.0%} of all pairs of variants were "
            "together or apart as here."
        )
    ]
    if len(analysis.groups) > 1:
        sentences.append(
            f"Two variants of a group stayed together in at least {together.min():.0%} of the "
            f"replicates{_least(analysis, together)}, and apart from those of another group in at "
            f"least {apart.min():.0%}{_least(analysis, apart)}."
        )
    return sentences


def _least(analysis: Analysis, shares: FloatArray) -> str:
    lowest = int(np.argmin(shares))
    return "" if shares[lowest] == 1.0 else f" ({analysis.groups[lowest].name} the least)"


def _about_choices(analysis: Analysis) -> list[str]:
    rows = [row for row in analysis.sensitivity if row.choice != NETWORKS]
    if not rows:
        return []
    same = sum(row.agreement >= _SAME for row in rows)
    others = min(rows, key=lambda row: row.agreement)
    sentence = f"With one choice of the analysis changed, {same} of {len(rows)} times the groups "
    if same == len(rows):
        return [f"{sentence}are the same."]
    sentence += f"are the same; the least alike is {others.choice} {others.value} "
    return [f"{sentence}(adjusted Rand index {others.agreement:.2f})."]


def _about_networks(analysis: Analysis) -> list[str]:
    n = analysis.n_networks
    if n == 1:
        return []  # a warning of its own
    sentences: list[str] = []
    if n < _MANY_NETWORKS:
        sentences.append(
            f"The trials are of {n} networks: the bootstrap speaks of training runs like these, as "
            "far as so few can."
        )
    alone = [row for row in analysis.sensitivity if row.choice == NETWORKS]
    if alone:
        listed = ", ".join(
            f"{row.value.removeprefix('only ')} {counted(row.n_groups, 'group')} "
            f"({row.agreement:.2f})"
            for row in alone
        )
        sentences.append(
            f"Each network by itself, with the adjusted Rand index to these groups: {listed}."
        )
    return sentences
