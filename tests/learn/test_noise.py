"""Correlated noise is standard normal at every moment and remembers as long as it says."""

from __future__ import annotations

import math

import numpy as np

from surmount.learn.noise import CorrelatedNoise

ROWS = 40_000


def drawn(correlation: float, steps: int) -> np.ndarray:
    """Return noise of many rows, shape ``(step, row)``."""
    rng = np.random.default_rng(0)
    noise = CorrelatedNoise(correlation)
    return np.array([noise.next(rng.standard_normal((ROWS, 1)))[:, 0] for _ in range(steps)])


def test_the_marginal_stays_standard_normal():
    noise = drawn(0.9, 30)
    # Standard errors over the rows: 1/√n of the mean, √(2/n) of the variance; five of them.
    np.testing.assert_allclose(noise.mean(axis=1), 0.0, atol=5 / math.sqrt(ROWS))
    np.testing.assert_allclose(noise.var(axis=1), 1.0, atol=5 * math.sqrt(2 / ROWS))
    np.testing.assert_allclose(
        (np.abs(noise) < 1.0).mean(axis=1), math.erf(math.sqrt(0.5)), atol=0.012
    )


def test_decisions_k_apart_are_correlated_by_the_kth_power():
    noise = drawn(0.9, 20)
    for apart in (1, 2, 5, 10, 19):
        correlation = np.corrcoef(noise[0], noise[apart])[0, 1]
        assert abs(correlation - 0.9**apart) < 5 / math.sqrt(ROWS)


def test_an_episode_begins_with_noise_of_its_own():
    rng = np.random.default_rng(1)
    noise = CorrelatedNoise(0.8)
    first, fresh = rng.standard_normal((2, 3, 2))
    noise.next(first, np.ones(3, dtype=bool))
    second = noise.next(fresh, np.array([False, True, False]))
    np.testing.assert_array_equal(second[1], fresh[1])
    np.testing.assert_allclose(second[[0, 2]], (0.8 * first + 0.6 * fresh)[[0, 2]], rtol=1e-12)


def test_it_goes_on_from_what_it_was():
    rng = np.random.default_rng(2)
    fresh = rng.standard_normal((6, 3, 2))
    whole = CorrelatedNoise(0.7)
    expected = [whole.next(numbers) for numbers in fresh]
    first = CorrelatedNoise(0.7)
    for numbers in fresh[:3]:
        first.next(numbers)
    second = CorrelatedNoise(0.7, first.newest)
    np.testing.assert_array_equal([second.next(numbers) for numbers in fresh[3:]], expected[3:])


def test_white_noise_is_what_was_drawn():
    noise = CorrelatedNoise(0.0)
    for numbers in np.random.default_rng(3).standard_normal((3, 4, 2)):
        np.testing.assert_array_equal(noise.next(numbers, np.zeros(4, dtype=bool)), numbers)
    assert noise.newest is None
