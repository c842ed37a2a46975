"""Probability of printed shares of new networks, against quadrature and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from surmount.stats.new_networks import PrintedCount, predict_printed

STEP = (
    PrintedCount(low=730, high=737, trials=390),
    PrintedCount(low=145, high=152, trials=390),
    PrintedCount(low=0, high=3, trials=120),
)
TRIALS = np.array([52, 52, 16])
PAPER = np.array([[49, 10, 0]])


def by_quadrature(successes: int, trials: int, printed: PrintedCount) -> float:
    """Return the log-probability for one network seen in one group, on plain grids.

    σ and τ enter as s = √(σ² + τ²) alone, whose density is that of the length of two half-normals:
    Rayleigh's. SciPy's distributions, nothing of the shipped code.
    """
    logits = np.arange(-18.0, 18.001, 0.06)
    rate = 1 / (1 + np.exp(-logits))
    seen = stats.binom.pmf(successes, trials, rate)
    first = stats.binom.pmf(np.arange(printed.trials + 1)[:, None], printed.trials, rate)
    total = np.zeros((logits.size, logits.size))
    for count in range(printed.trials + 1):
        upper = stats.binom.cdf(printed.high - count, printed.trials, rate)
        lower = stats.binom.cdf(printed.low - 1 - count, printed.trials, rate)
        total += np.multiply.outer(first[count], upper - lower)
    prior = stats.norm.pdf(logits, 0, 3)
    spreads = np.arange(0.1, 8.001, 0.1)
    numerator = denominator = 0.0
    for spread, density in zip(spreads, stats.rayleigh.pdf(spreads, scale=2), strict=True):
        kernel = stats.norm.pdf(logits[None], logits[:, None], spread)
        kernel /= kernel.sum(axis=1, keepdims=True)
        of_mean = prior * (kernel @ seen) * density
        denominator += of_mean.sum()
        numerator += of_mean @ np.einsum("ma,ab,mb->m", kernel, total, kernel, optimize=True)
    return float(np.log(numerator / denominator))


@pytest.mark.parametrize(("successes", "trials"), [(49, 52), (30, 52), (4, 4)])
def test_one_group_and_one_network_agree_with_quadrature(successes, trials):
    printed = PrintedCount(low=73, high=76, trials=40)
    found = predict_printed(np.array([[successes]]), np.array([trials]), [printed], seed=4)
    assert found.converged
    # Four standard errors, and 0.01 for the oracle's grids.
    assert found.log_probability == pytest.approx(
        by_quadrature(successes, trials, printed), abs=4 * found.standard_error + 0.01
    )
    assert np.log(found.of_group[0]) == pytest.approx(found.log_probability)


def test_probabilities_of_all_counts_together_are_one():
    parts = [PrintedCount(low=low, high=low + 8, trials=40) for low in range(0, 81, 9)]
    found = [predict_printed(np.array([[20]]), np.array([52]), [part], seed=1) for part in parts]
    # The same draws for each part, so that only the tables' interpolation is left.
    assert sum(part.of_group[0] for part in found) == pytest.approx(1.0, abs=1e-9)


def test_other_draws_change_the_logarithm_by_less_than_a_twentieth():
    successes = np.array([[49, 10, 0], [44, 21, 0], [50, 3, 0]])
    found = [predict_printed(successes, TRIALS, STEP, seed=seed) for seed in range(4)]
    values = [part.log_probability for part in found]
    assert np.std(values, ddof=1) < 0.05
    assert all(part.standard_error <= 0.03 for part in found)


@pytest.mark.parametrize("shift", [(-20, 0, 0), (0, 20, 0), (0, 0, 8), (-48, -10, 0), (3, 42, 16)])
def test_the_papers_own_success_is_more_likely_than_a_shifted_one(shift):
    own = predict_printed(PAPER, TRIALS, STEP)
    shifted = predict_printed(PAPER + np.array(shift), TRIALS, STEP, batches=(20, 20))
    assert own.log_probability > shifted.log_probability + 0.3


def test_more_networks_with_the_papers_success_make_it_more_likely():
    one, three = (
        predict_printed(np.repeat(PAPER, count, axis=0), TRIALS, STEP).log_probability
        for count in (1, 3)
    )
    assert three > one + 1


def test_networks_that_differ_are_told_from_their_mean():
    alike = predict_printed(np.array([[50], [50]]), np.array([52]), STEP[:1])
    unlike = predict_printed(np.array([[52], [0]]), np.array([52]), STEP[:1])
    half = predict_printed(np.array([[26], [26]]), np.array([52]), STEP[:1])
    assert alike.log_probability > unlike.log_probability > half.log_probability


def test_the_order_of_networks_does_not_matter():
    networks = np.array([[52, 20, 1], [40, 0, 0], [45, 9, 0]])
    first, second = (
        predict_printed(networks[order], TRIALS, STEP, batches=(3, 3))
        for order in ([0, 1, 2], [2, 0, 1])
    )
    assert first.log_probability == second.log_probability


def test_what_cannot_be_is_improbable_and_says_that_it_is_not_sure():
    never = predict_printed(np.zeros((3, 3), dtype=np.int64), TRIALS, STEP, batches=(4, 4))
    assert never.log_probability < -10
    assert not never.converged
