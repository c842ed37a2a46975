"""Where the links of a dendrogram are drawn, to which group each belongs, and where it was cut."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.cluster import hierarchy

from surmount.analysis.result import Analysis
from surmount.core.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, kw_only=True, eq=False)
class DendrogramLayout:
    """A dendrogram as drawn, leaves along one axis and heights along the other.

    Attributes
    ----------
    leaves
        Variants in the order in which they stand, shape ``(variant,)``; variant ``leaves[i]``
        stands at position ``i``.
    positions
        Where each link's two children stand, shape ``(link, 2)``.
    heights
        Heights of each link's children and of the link itself, shape ``(link, 3)``.
    group
        Group that all variants below a link belong to, −1 where there are several, ``(link,)``.
    divided
        Links at which the rule divides, shape ``(link,)``.
    cut
        Links that the rule cuts: these and all above them, shape ``(link,)``.
    cut_height
        A height that separates cut links from whole ones; ``None`` where there is none.
    """

    leaves: IntArray
    positions: FloatArray
    heights: FloatArray
    group: IntArray
    divided: BoolArray
    cut: BoolArray
    cut_height: float | None


def layout(analysis: Analysis) -> DendrogramLayout:
    """Lay out the dendrogram of an analysis."""
    dendrogram, n = analysis.dendrogram, analysis.variants.shape[0]
    leaves = hierarchy.leaves_list(_upright(analysis)).astype(np.int64)
    place = np.empty(2 * n - 1)
    place[leaves] = np.arange(n)
    height = np.concatenate([np.zeros(n), dendrogram.heights])
    cut = np.zeros(2 * n - 1, dtype=np.bool_)
    positions, heights = np.empty((n - 1, 2)), np.empty((n - 1, 3))
    group = np.full(n - 1, -1, dtype=np.int64)
    for link in range(n - 1):
        children = list(dendrogram.children(link))
        positions[link] = place[children]
        heights[link] = [*height[children], height[n + link]]
        place[n + link] = positions[link].mean()
        cut[n + link] = analysis.cut.divided[link] or cut[children].any()
        below = np.unique(analysis.labels[dendrogram.leaves(n + link)])
        if below.size == 1:
            group[link] = below[0]
    return DendrogramLayout(
        leaves=leaves,
        positions=positions,
        heights=heights,
        group=group,
        divided=analysis.cut.divided,
        cut=cut[n:],
        cut_height=_cut_height(dendrogram.heights, cut[n:]),
    )


def _upright(analysis: Analysis) -> FloatArray:
    """Return the linkage with each link's children in ascending order of their first variant."""
    links, n = analysis.linkage.copy(), analysis.variants.shape[0]
    first = [int(analysis.dendrogram.leaves(cluster)[0]) for cluster in range(2 * n - 1)]
    for link in links:
        if first[int(link[0])] > first[int(link[1])]:
            link[[0, 1]] = link[[1, 0]]
    return links


def _cut_height(heights: FloatArray, cut: BoolArray) -> float | None:
    if not cut.any():
        return None
    lowest = float(heights[cut].min())
    highest = float(heights[~cut].max()) if not cut.all() else 0.0
    return (lowest + highest) / 2 if highest < lowest else None
