"""The dendrogram: links between groups of variants, and how inconsistent each link is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Dendrogram:
    """An agglomerative clustering of variants.

    Attributes
    ----------
    links
        SciPy's linkage matrix, shape ``(link, 4)``: the two clusters joined (below the number of
        variants: a variant, above: an earlier link), the height, and the variants below.
    """

    links: FloatArray

    @property
    def n_leaves(self) -> int:
        """Number of variants."""
        return int(self.links.shape[0]) + 1

    @property
    def heights(self) -> FloatArray:
        """Height of each link, ascending, shape ``(link,)``."""
        return self.links[:, 2]

    def children(self, link: int) -> tuple[int, int]:
        """Return the two clusters that a link joins."""
        return int(self.links[link, 0]), int(self.links[link, 1])

    def leaves(self, cluster: int) -> IntArray:
        """Return the variants below a cluster, ascending."""
        found: list[int] = []
        open_clusters = [cluster]
        while open_clusters:
            current = open_clusters.pop()
            if current < self.n_leaves:
                found.append(current)
            else:
                open_clusters += self.children(current - self.n_leaves)
        return np.asarray(sorted(found), dtype=np.int64)

    def links_below(self, link: int) -> IntArray:
        """Return the links strictly below a link, ascending."""
        found: list[int] = []
        open_links = [link]
        while open_links:
            for child in self.children(open_links.pop()):
                if child >= self.n_leaves:
                    found.append(child - self.n_leaves)
                    open_links.append(child - self.n_leaves)
        return np.asarray(sorted(found), dtype=np.int64)

    def parents(self) -> IntArray:
        """Return the link above each cluster, −1 for the root, shape ``(cluster,)``."""
        parent = np.full(2 * self.n_leaves - 1, -1, dtype=np.int64)
        for link in range(self.links.shape[0]):
            for child in self.children(link):
                parent[child] = link
        return parent

    def inconsistency(self, depth: int) -> FloatArray:
        """Return the inconsistency coefficient of each link (SciPy and MATLAB agree on it).

        Parameters
        ----------
        depth
            Levels of links, the link itself included, that enter mean and standard deviation;
            0 means all links below.
        """
        from scipy.cluster import hierarchy  # noqa: PLC0415 - slow; not for a list of teachers

        statistics = hierarchy.inconsistent(self.links, depth or self.n_leaves)
        return np.asarray(statistics[:, 3], dtype=np.float64)

    def labels(self, divided: BoolArray) -> IntArray:
        """Return the group of each variant where the divided links are cut, with all above them.

        Parameters
        ----------
        divided
            Which links divide, shape ``(link,)``.

        Returns
        -------
        IntArray
            Groups numbered in the order of their first variant, shape ``(variant,)``.
        """
        n = self.n_leaves
        whole = np.ones(2 * n - 1, dtype=np.bool_)
        owner = np.arange(n)
        members: dict[int, list[int]] = {leaf: [leaf] for leaf in range(n)}
        for link in range(n - 1):
            left, right = self.children(link)
            whole[n + link] = whole[left] and whole[right] and not divided[link]
            members[n + link] = members.pop(left) + members.pop(right)
            if whole[n + link]:
                owner[members[n + link]] = n + link
        return relabelled(owner)


def build_dendrogram(distances: FloatArray, method: str) -> Dendrogram:
    """Cluster variants by their distance matrix, shape ``(variant, variant)``.

    Ward linkage treats distances as if they were Euclidean, which Hellinger distances between
    densities are, and their unscented estimates nearly.
    """
    from scipy.cluster import hierarchy  # noqa: PLC0415 - slow; not for a list of teachers
    from scipy.spatial.distance import squareform  # noqa: PLC0415

    condensed = squareform(distances, checks=False)
    links = np.asarray(hierarchy.linkage(condensed, method=method), dtype=np.float64)
    return Dendrogram(links=links)


def relabelled(labels: IntArray) -> IntArray:
    """Return labels numbered in the order in which they first occur."""
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    return rank[inverse].astype(np.int64)
