"""Shuffled steps are the same steps under other names, one to one."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.core.errors import InputError
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.family import ObstacleFamily
from surmount.rstar.shuffled import STEP, Codes, ShuffledFamily, shuffled_order
from surmount.tasks.distribution import TaskDistribution

FAMILY = ShuffledFamily()
CONFIG = EnvConfig()
CODES = Codes()


def test_every_variant_has_one_code_and_neighbours_have_little_in_common():
    codes = np.arange(30.0)
    assert sorted(CODES.heights(codes)) == STEP.variants.tolist()
    np.testing.assert_array_equal(CODES.codes(CODES.heights(codes)), codes)
    # Correlation of code and height; by chance its standard deviation is 1/√29.
    assert abs(np.corrcoef(codes, CODES.heights(codes))[0, 1]) < 2 / np.sqrt(29)
    assert np.abs(np.diff(CODES.heights(codes))).mean() > 5
    assert shuffled_order().tolist()[:3] == shuffled_order().tolist()[:3]


def test_codes_beside_the_middle_are_heights_beside_it_except_at_the_ends_of_the_range():
    codes = np.random.default_rng(0).uniform(-0.5, 29.5, 2_000)
    heights = CODES.heights(codes)
    assert heights.min() >= STEP.lower
    assert heights.max() <= STEP.upper
    inner = (heights > STEP.lower) & (heights < STEP.upper)
    np.testing.assert_allclose(CODES.codes(heights[inner]), codes[inner], atol=1e-9)
    assert inner.mean() > 0.95


def test_a_distribution_of_codes_draws_the_heights_that_they_stand_for():
    of_codes = TaskDistribution(
        parameters=("code",),
        weights=np.array([0.5, 0.3, 0.2]),
        lower=np.array([[2.2], [7.0], [12.5]]),
        upper=np.array([[5.7], [7.0], [13.5]]),
    )
    rng = np.random.default_rng(1)
    drawn = CODES.in_heights(of_codes).sample(rng, 40_000)[:, 0]
    expected = CODES.heights(of_codes.sample(rng, 40_000)[:, 0])
    edges = np.arange(20.5, 51.0)
    # Five standard errors of the difference of two shares of one half.
    np.testing.assert_allclose(
        np.histogram(drawn, edges)[0] / 40_000,
        np.histogram(expected, edges)[0] / 40_000,
        atol=5 * 0.5 * np.sqrt(2 / 40_000),
    )


def test_the_robot_meets_and_sees_the_same_steps_as_without_codes():
    plain = ObstacleFamily(STEP).trial_env(CONFIG, 3)
    coded = FAMILY.trial_env(CONFIG, 3)
    heights = np.array([[21.0], [35.0], [50.0]])
    seen, infos = coded.reset(seed=0, options={"variant": CODES.codes(heights)})
    expected, _ = plain.reset(seed=0, options={"variant": heights})
    np.testing.assert_array_equal(seen, expected)
    np.testing.assert_array_equal(infos["variant"], CODES.codes(heights))
    for _ in range(3):
        action = np.full((3, 3), 0.5)
        np.testing.assert_array_equal(coded.step(action)[0], plain.step(action)[0])
    plain.close()
    coded.close()


def test_training_draws_codes_goes_on_from_a_state_and_refuses_other_parameters():
    env = FAMILY.training_env(CONFIG, 4)
    only = FAMILY.space(CONFIG).variants[17]
    env.set_task_distribution(TaskDistribution.uniform(("code",), only, only))
    _, infos = env.reset(seed=0)
    assert infos["variant"][:, 0].tolist() == [17.0] * 4
    state = env.state_dict()
    other = FAMILY.training_env(CONFIG, 4)
    other.load_state_dict(state)
    action = np.full((4, 3), -0.5)
    np.testing.assert_array_equal(env.step(action)[0], other.step(action)[0])
    with pytest.raises(InputError, match="parameters"):
        env.set_task_distribution(TaskDistribution.uniform(("height_mm",), only, only))
    env.close()
    other.close()


def test_the_right_groups_are_the_papers_and_scattered_over_the_codes():
    space = FAMILY.space(CONFIG)
    names, group = FAMILY.right_groups(space.variants)
    assert names == ("easy", "medium", "difficult")
    assert np.bincount(group).tolist() == [13, 13, 4]
    assert (np.diff(group) != 0).sum() > 8
