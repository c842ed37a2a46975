"""Task distributions are the mixtures of eq. 4, for any number of parameters."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from surmount.core.errors import InputError
from surmount.core.seeds import derive_seed
from surmount.tasks.distribution import TaskDistribution

MIXTURE = TaskDistribution(
    parameters=("height_mm",),
    weights=np.array([0.7, 0.3, 0.0]),
    lower=np.array([[20.0], [40.0], [60.0]]),
    upper=np.array([[30.0], [45.0], [61.0]]),
)


def mixture_cdf(x):
    """P(X <= x) of eq. 4 in closed form."""
    parts = [
        weight * stats.uniform.cdf(x, low, high - low)
        for weight, low, high in zip(
            MIXTURE.weights, MIXTURE.lower[:, 0], MIXTURE.upper[:, 0], strict=True
        )
    ]
    return np.sum(parts, axis=0)


def test_samples_follow_the_mixture():
    sample = MIXTURE.sample(np.random.default_rng(0), 5_000)[:, 0]
    # Kolmogorov-Smirnov at 0.1 %: a fixed seed, so this is no coin toss.
    assert stats.kstest(sample, mixture_cdf).pvalue > 1e-3
    assert not (sample > 60).any()


def test_boxes_couple_their_parameters():
    diagonal = TaskDistribution(
        parameters=("a", "b"),
        weights=np.array([0.5, 0.5]),
        lower=np.array([[0.0, 0.0], [1.0, 1.0]]),
        upper=np.array([[0.5, 0.5], [1.5, 1.5]]),
    )
    sample = diagonal.sample(np.random.default_rng(0), 500)
    np.testing.assert_array_equal(sample[:, 0] >= 1, sample[:, 1] >= 1)


def test_a_box_without_width_is_a_single_value():
    point = TaskDistribution.uniform(("a",), np.array([3.0]), np.array([3.0]))
    assert (point.sample(np.random.default_rng(0), 5) == 3.0).all()


def test_the_json_form_gives_the_same_distribution_back():
    again = TaskDistribution.from_record(MIXTURE.to_record())
    rng, rng_again = np.random.default_rng(1), np.random.default_rng(1)
    np.testing.assert_array_equal(MIXTURE.sample(rng, 50), again.sample(rng_again, 50))


@pytest.mark.parametrize(
    "change",
    [
        {"weights": np.array([0.7, 0.7, 0.0])},
        {"weights": np.array([1.7, -0.7, 0.0])},
        {"weights": np.array([0.5, 0.5])},
        {"lower": np.array([[31.0], [40.0], [60.0]])},
        {"upper": np.array([[np.inf], [45.0], [61.0]])},
        {"parameters": ("a", "b")},
    ],
)
def test_impossible_mixtures_are_refused(change):
    with pytest.raises(InputError):
        TaskDistribution(**(vars(MIXTURE) | change))


def test_derived_seeds_depend_on_root_and_name_alone():
    # Recorded once: seeds must never change between versions, or old results do not repeat.
    assert derive_seed(0, "step", "initiation/network-0") == 1497962093
    names = [("a", "b"), ("ab",), ("a", "b", ""), (1,), ("1",)]
    seeds = {derive_seed(root, *name) for root in (0, 1) for name in names}
    assert len(seeds) == 2 * len(names)
