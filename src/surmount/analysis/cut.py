"""Where to cut the dendrogram into groups: "divisions for which similarities change abruptly"."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.dendrogram import Dendrogram
from surmount.core.arrays import BoolArray, FloatArray, IntArray

DEFAULT_CUT_OFF = {"abrupt": 1.5, "inconsistency": 2.4}
"""Cut-offs where the configuration gives none; measured in ADR 10 and 11."""
_SMALLEST_GAP = 1e-3
"""Usual gaps are at least this: identical recordings must not make all else abrupt."""
_QUANTILE = 0.25
"""Quantile of the gaps inside a side that stands for the usual one."""
_FEWEST_GAPS = 2
"""Gaps that a side needs for a usual one: three variants."""
_LARGEST_DISTANCE = 1.0 - 1e-9
"""Larger distances mean that nothing overlaps; how little is beyond the estimate."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cut:
    """Groups of variants as the dendrogram's links divide them, before small ones are merged.

    Attributes
    ----------
    method, cut_off
        The rule, and its threshold; 0 for rules without one.
    statistic
        The rule's measure of each link, shape ``(link,)``: the larger, the more abrupt.
    divided
        Which links divide, shape ``(link,)``; a link above a divided link is cut with it.
    labels
        Group of each variant, shape ``(variant,)``.
    """

    method: str
    cut_off: float
    statistic: FloatArray
    divided: BoolArray
    labels: IntArray


def cut_dendrogram(dendrogram: Dendrogram, distances: FloatArray, config: AnalysisConfig) -> Cut:
    """Cut a dendrogram by the configured rule."""
    cut_off = config.cut_off or DEFAULT_CUT_OFF.get(config.cut, 0.0)
    if config.cut == "abrupt":
        statistic = abruptness(dendrogram, distances, config.alike_distance)
        divided = statistic > cut_off
    elif config.cut == "inconsistency":
        statistic = dendrogram.inconsistency(config.inconsistency_depth)
        divided = statistic > cut_off
    else:
        statistic = dendrogram.heights.copy()
        if config.cut == "largest gap":
            n_groups = count_by_largest_gap(dendrogram)
        elif config.cut == "silhouette":
            n_groups = count_by_silhouette(dendrogram, distances)
        else:
            n_groups = min(config.group_count, dendrogram.n_leaves)
        divided = np.arange(dendrogram.links.shape[0]) >= dendrogram.n_leaves - n_groups
    return Cut(
        method=config.cut,
        cut_off=cut_off,
        statistic=statistic,
        divided=divided,
        labels=dendrogram.labels(divided),
    )


def may_divide(cut: Cut) -> bool:
    """Whether there are variants enough for the rule to divide them at all.

    A gap is abrupt beside those within a side of three variants; other rules compare links.
    """
    fewest = {"fixed count": 1, "abrupt": 4}.get(cut.method, 3)
    return cut.labels.size >= fewest


def abruptness(
    dendrogram: Dendrogram, distances: FloatArray, alike_distance: float = 0.0
) -> FloatArray:
    """Return how many times wider the gap at each link is than gaps inside the tighter side.

    A side's usual gap is the lower quartile of the gaps (:func:`link_gaps`) of the links inside
    it. The quartile and the tighter side, because variants half-way between two behaviours join
    one side or the other at wide gaps: these show the change, not how alike variants of one
    behaviour are. Sides of two variants have one gap, too little to tell what is usual, and count
    for nothing. Behaviours nearer than ``alike_distance`` are alike however near others are: long
    recordings make gaps within a group so small that their scatter alone would look abrupt.

    Parameters
    ----------
    dendrogram
        The clustering.
    distances
        Hellinger distances, shape ``(variant, variant)``.
    alike_distance
        Smallest usual gap, as a Hellinger distance.

    Returns
    -------
    FloatArray
        Shape ``(link,)``; 0 for links with no side of three variants or more.
    """
    gaps = link_gaps(dendrogram, distances)
    usual = np.full(2 * dendrogram.n_leaves - 1, np.inf)
    result = np.zeros_like(gaps)
    smallest = max(float(separation(np.asarray(alike_distance))), _SMALLEST_GAP)
    for link in range(gaps.size):
        reference = min(usual[child] for child in dendrogram.children(link))
        result[link] = gaps[link] / max(float(reference), smallest)
        inside = np.append(dendrogram.links_below(link), link)
        if inside.size >= _FEWEST_GAPS:
            usual[dendrogram.n_leaves + link] = np.quantile(gaps[inside], _QUANTILE)
    return result


def link_gaps(dendrogram: Dendrogram, distances: FloatArray) -> FloatArray:
    """Return the gap at each link, shape ``(link,)``.

    It is the smallest :func:`separation` between a variant on its one side and a variant on the
    other: behaviour that drifts steadily from variant to variant crosses gaps of one size, and an
    abrupt change crosses a wide one.
    """
    apart = separation(distances)
    gaps = np.zeros(dendrogram.links.shape[0])
    for link in range(gaps.size):
        left, right = (dendrogram.leaves(child) for child in dendrogram.children(link))
        gaps[link] = apart[np.ix_(left, right)].min()
    return gaps


def separation(distances: FloatArray) -> FloatArray:
    """Return √(−ln(1 − D²)): for two Gaussians of one covariance, proportional to their shift.

    The Hellinger distance itself levels off at 1, so that differences far beyond the noise look
    hardly larger than the noise; this scale does not level off.
    """
    return np.sqrt(-np.log1p(-np.square(np.minimum(distances, _LARGEST_DISTANCE))))


def count_by_largest_gap(dendrogram: Dendrogram) -> int:
    """Return the number of groups that the largest gap between neighbouring heights leaves."""
    gaps = np.diff(dendrogram.heights)
    return 1 if gaps.size == 0 else dendrogram.n_leaves - 1 - int(np.argmax(gaps))


def count_by_silhouette(dendrogram: Dendrogram, distances: FloatArray) -> int:
    """Return the number of groups, at least 2, of the largest mean silhouette."""
    n = dendrogram.n_leaves
    best, best_value = 1, -np.inf
    for n_groups in range(2, n):
        divided = np.arange(n - 1) >= n - n_groups
        value = mean_silhouette(distances, dendrogram.labels(divided))
        if value > best_value:
            best, best_value = n_groups, value
    return best


def mean_silhouette(distances: FloatArray, labels: IntArray) -> float:
    """Return the mean silhouette of a grouping (Rousseeuw 1987); groups of one count 0."""
    members = np.eye(int(labels.max()) + 1)[labels]  # (variant, group)
    sizes = members.sum(axis=0)
    sums = distances @ members
    own = sums[np.arange(labels.size), labels] / np.maximum(sizes[labels] - 1, 1)
    others = np.where(members > 0, np.inf, sums / sizes)
    nearest = others.min(axis=1)
    top = np.maximum(own, nearest)
    values = np.where((sizes[labels] > 1) & (top > 0), (nearest - own) / np.maximum(top, 1e-300), 0)
    return float(values.mean())
