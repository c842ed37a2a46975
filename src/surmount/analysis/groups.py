"""From a cut to groups: small ones merged, the rest ranked and named (paper II-B)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.dendrogram import Dendrogram, relabelled
from surmount.core.arrays import FloatArray, IntArray


@dataclass(frozen=True, kw_only=True)
class Merge:
    """One small group merged into its neighbour.

    Attributes
    ----------
    members
        Indices of the small group's variants.
    into
        Indices of the receiving group's variants.
    height
        Height of the link at which the dendrogram joins them.
    limit
        Largest size that counted as small.
    """

    members: tuple[int, ...]
    into: tuple[int, ...]
    height: float
    limit: int


def small_limit(n_variants: int, config: AnalysisConfig) -> int:
    """Return the largest number of variants that makes a group small."""
    return max(config.small_group_size, int(config.small_group_fraction * n_variants + 1e-9))


def merge_small(
    labels: IntArray, dendrogram: Dendrogram, distances: FloatArray, limit: int
) -> tuple[IntArray, tuple[Merge, ...]]:
    """Merge groups of at most ``limit`` variants into their neighbour in the dendrogram.

    The neighbour is the group met first on the way up from the small one; where several are met
    at the same link, the one with the smallest mean distance. Smallest groups go first, and of
    equal ones that which joins at the lowest link.

    Parameters
    ----------
    labels
        Group of each variant, shape ``(variant,)``.
    dendrogram, distances
        The clustering, and the distances of shape ``(variant, variant)``.
    limit
        Largest size of a small group.

    Returns
    -------
    tuple
        Labels after merging, and the merges in their order.
    """
    current = labels.copy()
    merges: list[Merge] = []
    while True:
        groups = [np.flatnonzero(current == label) for label in np.unique(current)]
        small = [group for group in groups if group.size <= limit]
        if len(groups) < 2 or not small:
            return relabelled(current), tuple(merges)
        chosen = min(
            ((group, *_neighbour(group, current, dendrogram, distances)) for group in small),
            key=lambda entry: (entry[0].size, entry[2], entry[0][0]),
        )
        group, receiver, height = chosen
        merges.append(
            Merge(
                members=tuple(int(i) for i in group),
                into=tuple(int(i) for i in np.flatnonzero(current == receiver)),
                height=height,
                limit=limit,
            )
        )
        current[group] = receiver


def _neighbour(
    group: IntArray, labels: IntArray, dendrogram: Dendrogram, distances: FloatArray
) -> tuple[int, float]:
    own = labels[group[0]]
    parents = dendrogram.parents()
    cluster = int(group[0])
    while True:
        link = int(parents[cluster])
        cluster = dendrogram.n_leaves + link
        met = dendrogram.leaves(cluster)
        others = np.unique(labels[met[labels[met] != own]])
        if others.size:
            means = [distances[np.ix_(group, labels == other)].mean() for other in others]
            return int(others[int(np.argmin(means))]), float(dendrogram.heights[link])


def rank_groups(labels: IntArray, success_rate: FloatArray) -> tuple[list[IntArray], list[float]]:
    """Return groups from the highest mean success rate to the lowest, with these rates.

    Groups of equal success keep the order of their first variant.
    """
    groups = [np.flatnonzero(labels == label) for label in np.unique(labels)]
    rates = [float(success_rate[group].mean()) for group in groups]
    order = sorted(range(len(groups)), key=lambda i: (-rates[i], int(groups[i][0])))
    return [groups[i] for i in order], [rates[i] for i in order]


def group_names(n_groups: int) -> Sequence[str]:
    """Return names in order of success: words up to three groups, numbers beyond."""
    words = {1: ("all",), 2: ("easy", "difficult"), 3: ("easy", "medium", "difficult")}
    return words.get(n_groups) or [f"group {number}" for number in range(1, n_groups + 1)]
