"""Links, inconsistency and labels against SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.cluster import hierarchy
from scipy.spatial.distance import pdist, squareform
from strategies import seeds

from surmount.analysis.dendrogram import build_dendrogram, relabelled


def distances(seed: int, n: int) -> np.ndarray:
    points = np.random.default_rng(seed).standard_normal((n, 3))
    return squareform(pdist(points)) / 10.0


@given(seed=seeds, n=st.integers(2, 20), cut_off=st.floats(0.1, 2.5), depth=st.integers(2, 6))
@settings(max_examples=80)
def test_labels_of_links_above_a_cut_off_are_those_of_scipys_fcluster(seed, n, cut_off, depth):
    dendrogram = build_dendrogram(distances(seed, n), "average")
    coefficients = dendrogram.inconsistency(depth)
    ours = dendrogram.labels(coefficients > cut_off)
    theirs = hierarchy.fcluster(dendrogram.links, cut_off, criterion="inconsistent", depth=depth)
    assert ours.tolist() == relabelled(theirs.astype(np.int64)).tolist()


def test_inconsistency_at_depth_2_never_exceeds_two_over_root_three():
    dendrogram = build_dendrogram(distances(0, 60), "average")
    assert dendrogram.inconsistency(2).max() <= 2.0 / np.sqrt(3.0) + 1e-12
    assert dendrogram.inconsistency(0).max() > 2.0


def test_inconsistency_of_a_hand_made_dendrogram_follows_the_definition():
    points = np.array([[0.0], [1.0], [4.0], [14.0]])
    dendrogram = build_dendrogram(squareform(pdist(points)), "single")
    assert dendrogram.heights.tolist() == [1.0, 3.0, 10.0]
    below = np.array([1.0, 3.0, 10.0])
    expected = (10.0 - below.mean()) / below.std(ddof=1)
    assert dendrogram.inconsistency(0)[2] == pytest.approx(expected, abs=1e-12)
    assert dendrogram.inconsistency(2)[2] == pytest.approx((10 - 6.5) / np.std([3, 10], ddof=1))


def test_leaves_and_links_below_describe_the_tree():
    dendrogram = build_dendrogram(distances(1, 12), "complete")
    root = dendrogram.links.shape[0] - 1
    assert dendrogram.leaves(12 + root).tolist() == list(range(12))
    assert dendrogram.links_below(root).tolist() == list(range(root))
    for link in range(root + 1):
        assert dendrogram.leaves(12 + link).size == dendrogram.links[link, 3]
    parents = dendrogram.parents()
    assert parents[12 + root] == -1
    assert all(cluster in dendrogram.children(parents[cluster]) for cluster in range(12 + root))


def test_labels_are_numbered_in_the_order_of_first_occurrence():
    assert relabelled(np.array([7, 7, 2, 9, 2])).tolist() == [0, 0, 1, 2, 1]
