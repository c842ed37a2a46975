"""Merging, ranking, bounds and levels against the rules of the paper."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import seeds

from surmount import AnalysisConfig
from surmount.analysis.dendrogram import build_dendrogram
from surmount.analysis.group_boxes import group_boxes
from surmount.analysis.groups import group_names, merge_small, rank_groups, small_limit
from surmount.analysis.levels import build_levels, level_weights
from surmount.tasks.cells import cells


def line(positions):
    positions = np.asarray(positions, dtype=float)
    return np.abs(positions[:, None] - positions) / 100.0


def merged(positions, labels, limit):
    distances = line(positions)
    return merge_small(np.array(labels), build_dendrogram(distances, "average"), distances, limit)


def test_a_small_group_joins_its_nearest_neighbour_and_says_so():
    labels, merges = merged([0, 1, 2, 10, 30, 31, 32], [0, 0, 0, 1, 2, 2, 2], limit=2)
    assert labels.tolist() == [0, 0, 0, 0, 1, 1, 1]
    (merge,) = merges
    assert (merge.members, merge.into, merge.limit) == ((3,), (0, 1, 2), 2)
    assert merge.height == pytest.approx(0.09)


def test_small_groups_merge_until_none_is_left():
    labels, merges = merged([0, 1, 10, 11, 50, 51, 52], [0, 0, 1, 1, 2, 2, 2], limit=2)
    assert labels.tolist() == [0, 0, 0, 0, 1, 1, 1]
    assert len(merges) == 1


def test_a_family_of_small_groups_only_becomes_one_group():
    assert merged([0, 50, 90], [0, 1, 2], limit=2)[0].tolist() == [0, 0, 0]


def test_limit_is_the_larger_of_the_papers_two_wordings():
    assert small_limit(30, AnalysisConfig()) == 2
    assert small_limit(30, AnalysisConfig(small_group_fraction=0.1)) == 3
    assert small_limit(15, AnalysisConfig(small_group_fraction=0.1)) == 2


def test_groups_rank_by_mean_success_of_their_variants():
    members, rates = rank_groups(np.array([0, 0, 1, 2, 2]), np.array([0.2, 0.4, 0.9, 1.0, 0.6]))
    assert [group.tolist() for group in members] == [[2], [3, 4], [0, 1]]
    assert rates == pytest.approx([0.9, 0.8, 0.3])


def test_names_follow_the_paper_up_to_three_groups():
    assert list(group_names(2)) == ["easy", "difficult"]
    assert list(group_names(3)) == ["easy", "medium", "difficult"]
    assert list(group_names(4)) == ["group 1", "group 2", "group 3", "group 4"]


def test_halfway_bounds_meet_between_groups_and_end_at_the_family():
    variants = np.array([[21.0], [22.0], [23.0], [30.0], [31.0]])
    (low,) = group_boxes(variants, np.array([0, 1, 2]), "halfway")
    (high,) = group_boxes(variants, np.array([3, 4]), "halfway")
    assert (low.lower[0], low.upper[0]) == (21.0, 26.5)
    assert (high.lower[0], high.upper[0]) == (26.5, 31.0)


def test_range_bounds_are_the_groups_own_outermost_variants():
    variants = np.array([[21.0], [22.0], [23.0], [30.0], [31.0]])
    (box,) = group_boxes(variants, np.array([0, 1, 2]), "range")
    assert (box.lower[0], box.upper[0]) == (21.0, 23.0)


def test_a_group_in_two_runs_has_two_intervals_weighted_by_variants():
    variants = np.arange(10.0)[:, None]
    boxes = group_boxes(variants, np.array([0, 1, 2, 7]), "halfway")
    assert [(b.lower[0], b.upper[0], b.weight) for b in boxes] == [(0, 2.5, 3), (6.5, 7.5, 1)]


def test_cells_of_a_grid_tile_its_range():
    axes = np.meshgrid([0.0, 1.0, 4.0], [10.0, 20.0], indexing="ij")
    lower, upper = cells(np.stack([axis.ravel() for axis in axes], axis=1))
    assert np.prod(upper - lower, axis=1).sum() == pytest.approx(4.0 * 10.0)


@given(seed=seeds, n=st.integers(2, 15), d=st.integers(2, 4))
@settings(max_examples=60)
def test_cells_of_scattered_variants_hold_their_variant_and_never_overlap(seed, n, d):
    variants = np.random.default_rng(seed).random((n, d)) * 10.0 ** np.arange(d)
    lower, upper = cells(variants)
    assert (lower <= variants).all()
    assert (variants <= upper).all()
    inner = np.minimum(upper[:, None], upper) - np.maximum(lower[:, None], lower)
    overlap = (inner > 1e-9 * np.ptp(variants, axis=0)).all(axis=2)
    assert not overlap[~np.eye(n, dtype=bool)].any()


@given(
    n=st.integers(1, 8),
    dominant=st.integers(0, 7),
    weight=st.floats(0.01, 1.0),
    share=st.floats(0.0, 1.0),
)
def test_weights_sum_to_one_and_favour_the_easier(n, dominant, weight, share):
    dominant = min(dominant, n - 1)
    config = AnalysisConfig(dominant_weight=weight, harder_share=share)
    weights = level_weights(dominant, n, config)
    assert len(weights) == n
    assert sum(weights) == pytest.approx(1.0, abs=1e-9)
    assert min(weights) >= 0.0
    assert list(weights[:dominant]) == sorted(weights[:dominant], reverse=True)
    assert list(weights[dominant + 1 :]) == sorted(weights[dominant + 1 :], reverse=True)


def test_default_weights_of_three_groups():
    config = AnalysisConfig()
    assert level_weights(1, 3, config) == (0.2, 0.7, 0.1)
    assert level_weights(2, 3, config) == (0.2, 0.1, 0.7)
    assert level_weights(0, 3, config) == (0.7, 0.2, 0.1)
    assert level_weights(0, 1, config) == (1.0,)


def test_groups_at_the_threshold_get_no_level():
    levels = build_levels(["easy", "medium", "difficult"], [0.95, 0.949, 0.0], AnalysisConfig())
    assert [level.dominant for level in levels] == ["medium", "difficult"]
