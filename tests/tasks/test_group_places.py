"""A curriculum whose variants and boxes contradict each other is refused, naming the variants."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surmount.analysis.group_boxes import group_boxes
from surmount.core.axis import CONTINUOUS, Axis
from surmount.core.errors import InputError
from surmount.tasks.curriculum import Curriculum, Group, Level

ROOT = Path(__file__).parents[2]
STORED = sorted(
    path
    for folder in ("docs", "examples")
    for path in (ROOT / folder).rglob("*curriculum*.json")
)  # fmt: skip
TERRAIN = Axis(kind="categorical", names=("flat", "mud", "ice"))


def curriculum(variants, labels, axes=(), rule="halfway") -> Curriculum:
    """Two groups of variants by their labels, 0 and 1, with the boxes of the analysis."""
    variants, labels = np.asarray(variants, dtype=float), np.asarray(labels)
    members = [np.flatnonzero(labels == label) for label in (0, 1)]
    return Curriculum(
        parameters=tuple("xyz"[: variants.shape[1]]),
        groups=tuple(
            Group(
                name=name,
                variants=variants[own],
                success_rate=rate,
                boxes=group_boxes(variants, own, rule, axes),
            )
            for name, rate, own in zip(("easy", "hard"), (0.9, 0.1), members, strict=True)
        ),
        levels=(Level(dominant="hard", weights=(0.3, 0.7)),),
        success_threshold=0.95,
        axes=axes,
    )


def edited(change, made: Curriculum | None = None) -> str:
    """Return why a curriculum cannot be loaded after a change of its JSON form."""
    record = (made or curriculum(np.arange(1.0, 8.0)[:, None], [0, 0, 0, 0, 1, 1, 1])).to_record()
    easy, hard = record["groups"]
    change(record, easy, hard)
    with pytest.raises(InputError) as caught:
        Curriculum.from_record(record, source="c.json")
    return caught.value.message


def test_there_are_curricula_in_this_repository():
    assert len(STORED) >= 10


@pytest.mark.parametrize("path", STORED, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_curriculum_of_this_repository_loads(path):
    assert Curriculum.load(path).groups


@pytest.mark.parametrize("rule", ["halfway", "range"])
@pytest.mark.parametrize("seed", range(5))
def test_whatever_groups_the_analysis_finds_they_agree_with_their_boxes(rule, seed):
    rng = np.random.default_rng(seed)
    line = np.sort(rng.uniform(1e-3, 1.0, 12))[:, None]
    whole = np.sort(rng.choice(40, 12, replace=False))[:, None]
    scattered = rng.normal(size=(12, 2))
    grid = np.stack(np.meshgrid([0.1, 1.0, 10.0], [0, 1, 2]), axis=-1).reshape(-1, 2)
    for variants, axes in (
        (line, (CONTINUOUS,)),
        (line, (Axis(kind="logarithmic"),)),
        (whole, (Axis(kind="integer"),)),
        (np.arange(3)[:, None], (TERRAIN,)),
        (scattered, (CONTINUOUS, CONTINUOUS)),
        (grid, (Axis(kind="logarithmic"), TERRAIN)),
    ):
        labels = rng.integers(0, 2, len(variants))
        labels[:2] = 0, 1  # neither is empty, and most interleave
        made = curriculum(variants, labels, axes, rule)
        assert Curriculum.from_record(made.to_record()).to_record() == made.to_record()


def test_bounds_that_leave_variants_outside_are_refused():
    def narrower(record, easy, hard):
        easy["boxes"][0]["upper"] = hard["boxes"][0]["lower"] = [2.5]

    told = edited(narrower)
    assert "variants 3, 4 of group `easy` lie in none of its boxes" in told
    assert "variants 3, 4 of group `easy` lie within the boxes of group `hard`" in told


def test_a_variant_that_is_moved_without_its_box_is_refused():
    def moved(record, easy, hard):
        hard["variants"].append(easy["variants"].pop())

    assert "variant 4 of group `hard` lies in none of its boxes" in edited(moved)


def test_a_variant_far_outside_is_refused():
    told = edited(lambda record, easy, hard: hard["variants"].append([99.0]))
    assert "variant 99 of group `hard` lies in none of its boxes" in told


def test_a_variant_in_two_groups_is_refused():
    def twice(record, easy, hard):
        hard["variants"].append([4.0])
        hard["boxes"][0]["lower"] = [4.0]

    assert "variant 4 of group `easy` lies in group `hard` as well" in edited(twice)


def test_a_category_that_another_group_draws_is_refused_by_its_name():
    made = curriculum([[0.0, 0], [0.0, 1], [1.0, 0], [1.0, 1]], [0, 1, 0, 1], (CONTINUOUS, TERRAIN))

    def muddy(record, easy, hard):
        hard["boxes"].append({"lower": [0.0, "flat"], "upper": [2.0, "flat"], "weight": 1.0})

    told = edited(muddy, made)
    assert "variant (1, flat) of group `easy` lies within the boxes of group `hard`" in told


def test_a_point_within_another_groups_range_may_be_practised_by_itself():
    record = curriculum(np.arange(1.0, 8.0)[:, None], [0, 0, 0, 0, 1, 1, 1]).to_record()
    easy = record["groups"][0]
    easy["variants"].append([6.5])
    easy["boxes"].append({"lower": [6.5], "upper": [6.5], "weight": 1.0})
    assert Curriculum.from_record(record).groups[0].variants[-1] == 6.5


def test_many_variants_are_not_all_named():
    made = curriculum(np.arange(20.0)[:, None], [0] * 10 + [1] * 10)
    told = edited(lambda record, easy, hard: easy["boxes"][0].update(upper=[0.0]), made)
    assert "variants 1, 2, 3, 4, 5 and 4 more of group `easy` lie in none of its boxes" in told


def test_a_level_whose_dominant_group_has_no_weight_is_refused():
    def weightless(record, easy, hard):
        record["levels"][0]["weights"] = {"easy": 1.0, "hard": 0.0}

    assert "`levels[0].dominant` is 'hard', whose weight is 0" in edited(weightless)
    assert "whose weight is 0" in edited(
        lambda record, easy, hard: record["levels"][0].update(weights={"easy": 1.0})
    )
