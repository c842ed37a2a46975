"""Regions count each task once, and agree with what a distribution draws."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.tasks.curriculum import Box, Curriculum, Group
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.regions import Regions, success_by_region


def group(name, *boxes):
    return Group(
        name=name,
        variants=np.array([boxes[0][0]]),
        success_rate=0.5,
        boxes=tuple(
            Box(lower=np.array(low), upper=np.array(high), weight=1.0) for low, high in boxes
        ),
    )


REGIONS = Regions.of(
    Curriculum(
        parameters=("a", "b"),
        groups=(
            group("left", ([0.0, 0.0], [1.0, 4.0])),
            group("rest", ([1.0, 0.0], [3.0, 2.0]), ([2.0, 2.0], [3.0, 4.0])),
        ),
        levels=(),
        success_threshold=0.95,
    )
)
MIXED = TaskDistribution(
    parameters=("a", "b"),
    weights=np.array([0.4, 0.3, 0.2, 0.1]),
    lower=np.array([[0.0, 0.0], [0.5, 1.0], [2.5, 3.0], [1.0, 1.0]]),
    upper=np.array([[3.0, 4.0], [2.5, 1.0], [2.5, 3.0], [1.0, 1.0]]),
)


def test_shares_are_those_of_many_draws():
    tasks = MIXED.sample(np.random.default_rng(0), 200_000)
    owner = REGIONS.index(tasks)
    drawn = [(owner == region).mean() for region in range(2)]
    # Five standard errors of a share among 200,000 draws.
    np.testing.assert_allclose(REGIONS.shares(MIXED), drawn, atol=5 * 0.5 / np.sqrt(200_000))
    assert (owner == -1).any()


def test_where_regions_meet_a_task_belongs_to_the_first():
    tasks = np.array([[1.0, 1.0], [1.5, 3.0], [2.0, 2.0], [9.0, 9.0]])
    assert REGIONS.index(tasks).tolist() == [0, -1, 1, -1]


def test_success_is_undefined_where_nothing_was_tried():
    rates = success_by_region(REGIONS, np.array([[0.5, 1.0], [0.7, 1.0]]), [True, False])
    assert rates == [0.5, None]
    assert success_by_region(REGIONS, np.empty((0, 2)), []) == [None, None]
    assert REGIONS.shares(MIXED).sum() == pytest.approx(0.4 * 10 / 12 + 0.3 + 0.2 + 0.1)
