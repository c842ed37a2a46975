"""How probable it is that two further networks show given success, after those one has seen.

Networks that were trained alike differ, and differ from group to group of variants. Network i
succeeds in group g with probability logistic(μ_g + b_i + e_ig), b_i ~ N(0, σ²), e_ig ~ N(0, τ²);
beforehand μ_g ~ N(0, 3²), σ and τ ~ half-normal(2). What is wanted is the probability, given the
successes of some networks, that two new ones together succeed so often that a share is printed.

By importance sampling without a chain. (σ, τ) are drawn from strata of their prior. Given them all
logits are jointly normal beforehand and their likelihood is log-concave, so a t distribution at
the mode with the curvature there (Laplace) proposes them well; the weights are exact. μ given the
logits is drawn in closed form. Batches are independent: their scatter gives the standard error,
and more are drawn until it is small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from surmount.core.arrays import FloatArray, IntArray

MEAN_SD = 3.0
"""Prior standard deviation of a group's mean logit: success from 0.3 to 99.7 % within two of it."""
SPREAD_SD = 2.0
"""Scale of the half-normal priors of σ and τ: with a spread of 2, networks of one kind reach from
2 to 98 %, as those on the step did; with one near 0 they are alike. Both stay possible."""

_PAIR_GRID = np.linspace(-16.0, 16.0, 641)
"""Logits of two new networks at which the probability of a printed share is tabulated."""
_STRATA = 12
_DRAWS = 36
_PAIRS = 16
"""Strata each of σ and of τ in a batch, draws of the logits in each, pairs of networks a draw."""
_FREEDOM = 6.0
"""Degrees of freedom of the proposal: its tails are heavier than the normal prior's."""
_NEWTON_STEPS = 15
_LEAST_SPREAD = 0.02
"""Smaller spreads are taken for this, which moves no success rate by more than half a point:
covariances stay far from singular."""


@dataclass(frozen=True, kw_only=True)
class PrintedCount:
    """Successes that two networks together may have had, as far as a printed share tells.

    Attributes
    ----------
    low, high
        Fewest and most successes.
    trials
        Trials of each of the two networks.
    """

    low: int
    high: int
    trials: int

    def table(self) -> FloatArray:
        """Return the probability of these counts by both networks' logits on the grid."""
        probability = special.expit(_PAIR_GRID)
        first = np.arange(self.trials + 1)
        log_choose = -special.betaln(first + 1, self.trials - first + 1) - np.log(self.trials + 1)
        log_pmf = log_choose + np.multiply.outer(special.log_expit(_PAIR_GRID), first)
        log_pmf += np.multiply.outer(special.log_expit(-_PAIR_GRID), self.trials - first)
        within = _below(self.high - first, self.trials, probability)
        within -= _below(self.low - 1 - first, self.trials, probability)
        return np.exp(log_pmf) @ within


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """Probability of what two new networks show.

    Attributes
    ----------
    log_probability
        Natural logarithm of the probability of all groups' printed counts together.
    standard_error
        Of that logarithm, by the scatter of batches; infinite where no draw came near.
    of_group
        Probability of each group's printed count alone, shape ``(group,)``.
    converged
        Whether the standard error asked for was reached.
    """

    log_probability: float
    standard_error: float
    of_group: FloatArray
    converged: bool


def predict_printed(
    successes: IntArray,
    trials: IntArray,
    printed: Sequence[PrintedCount],
    *,
    seed: int = 0,
    standard_error: float = 0.03,
    batches: tuple[int, int] = (20, 60),
) -> Prediction:
    """Return how probable printed shares of two new networks are.

    Parameters
    ----------
    successes
        Of each network seen, shape ``(network, group)``; their order does not matter.
    trials
        Of each network in each group, shape ``(group,)``.
    printed
        What two new networks together have shown, by group.
    seed
        Of the draws.
    standard_error
        Of the logarithm at which drawing ends.
    batches
        Least and greatest number of batches of 12 · 12 · 36 draws.
    """
    rng = np.random.default_rng(seed)
    ordered = successes[np.lexsort(successes.T)]
    tables = [count.table() for count in printed]
    sums: list[FloatArray] = []
    reference = None
    estimate = error = np.inf
    fewest, most = batches
    while len(sums) < most and (len(sums) < fewest or not error <= standard_error):
        log_weight, mean, sigma, tau = _posterior_draws(rng, ordered, trials)
        reference = log_weight.max() if reference is None else reference
        of_group = _of_new_networks(rng, mean, sigma, tau, tables)
        together = of_group.prod(axis=2)
        values = np.column_stack(
            [np.ones(len(together)), together.mean(axis=1), of_group.mean(axis=1)]
        )  # (draw, weight | all | groups)
        sums.append(np.exp(log_weight - reference) @ values)
        estimate, error = _ratio(np.array(sums))
    total = np.sum(sums, axis=0)
    return Prediction(
        log_probability=float(estimate),
        standard_error=float(error),
        of_group=total[2:] / total[0],
        converged=bool(error <= standard_error),
    )


def _below(counts: IntArray, trials: int, probability: FloatArray) -> FloatArray:
    """Return P(successes ≤ count), shape ``(count, probability)``; 0 below no success."""
    held = np.clip(counts, 0, trials)[:, None]
    cdf = special.bdtr(held.astype(np.float64), trials, probability[None])
    return np.where(counts[:, None] < 0, 0.0, cdf)


def _posterior_draws(
    rng: np.random.Generator, successes: IntArray, trials: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return weighted draws: log weights, μ of shape ``(draw, group)``, σ and τ."""
    sigma, tau = (grid.ravel() for grid in np.meshgrid(_half_normal(rng), _half_normal(rng)))
    precision = _precision(successes.shape[0], successes.shape[1], sigma, tau)
    flat, of_each = successes.ravel(), np.tile(trials, len(successes))
    mode, curvature = _mode(precision, flat, of_each)
    upper = np.swapaxes(np.linalg.cholesky(curvature), 1, 2)  # (spread, logit, logit)
    normal = rng.standard_normal((sigma.size, flat.size, _DRAWS))
    stretch = rng.chisquare(_FREEDOM, (sigma.size, 1, _DRAWS)) / _FREEDOM
    logits = mode[..., None] + np.linalg.solve(upper, normal / np.sqrt(stretch))
    squares = np.sum(normal**2, axis=1) / stretch[:, 0]
    log_proposal = -0.5 * (_FREEDOM + flat.size) * np.log1p(squares / _FREEDOM)
    log_proposal += np.log(np.diagonal(upper, axis1=1, axis2=2)).sum(axis=1)[:, None]
    log_prior = -0.5 * np.sum(logits * (precision @ logits), axis=1)
    log_prior += 0.5 * np.linalg.slogdet(precision)[1][:, None]
    log_likelihood = np.sum(
        flat[:, None] * special.log_expit(logits)
        + (of_each - flat)[:, None] * special.log_expit(-logits),
        axis=1,
    )
    log_weight = (log_prior + log_likelihood - log_proposal).ravel()
    drawn = np.swapaxes(logits, 1, 2).reshape(-1, *successes.shape)
    sigma, tau = (np.repeat(spread, _DRAWS) for spread in (sigma, tau))
    return log_weight, _mean_given(rng, drawn, sigma, tau), sigma, tau


def _precision(networks: int, groups: int, sigma: FloatArray, tau: FloatArray) -> FloatArray:
    """Return the inverse of 3² [same group] + σ² [same network] + τ² [same both], by spread."""
    same_group = np.kron(np.ones((networks, networks)), np.eye(groups))
    same_network = np.kron(np.eye(networks), np.ones((groups, groups)))
    within = np.multiply.outer(sigma**2, same_network)
    rest = np.multiply.outer(tau**2, np.eye(networks * groups))
    return np.linalg.inv(MEAN_SD**2 * same_group + within + rest).astype(np.float64)


def _mode(
    precision: FloatArray, successes: IntArray, trials: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return the most probable logits, ``(spread, logit)``, and the negative Hessian there.

    Steps of Newton's method, none longer than 2. Where they have not arrived the proposal is a
    worse one, which the weights make good.
    """
    start = np.log((successes + 0.5) / (trials - successes + 0.5))
    logits = np.tile(start, (len(precision), 1))
    for _ in range(_NEWTON_STEPS):
        probability = special.expit(logits)
        slope = successes - trials * probability
        slope = slope - np.squeeze(precision @ logits[..., None], axis=-1)
        curvature = precision + _diagonal(trials * probability * (1 - probability))
        step = np.squeeze(np.linalg.solve(curvature, slope[..., None]), axis=-1)
        logits = logits + np.clip(step, -2.0, 2.0)
    probability = special.expit(logits)
    return logits, precision + _diagonal(trials * probability * (1 - probability))


def _diagonal(values: FloatArray) -> FloatArray:
    return values[..., None] * np.eye(values.shape[-1])


def _half_normal(rng: np.random.Generator) -> FloatArray:
    """Return one draw from each stratum of the half-normal prior of a spread."""
    quantile = (np.arange(_STRATA) + rng.random(_STRATA)) / _STRATA
    return np.maximum(SPREAD_SD * special.ndtri(0.5 + 0.5 * quantile), _LEAST_SPREAD)


def _mean_given(
    rng: np.random.Generator, logits: FloatArray, sigma: FloatArray, tau: FloatArray
) -> FloatArray:
    """Draw μ given all logits: its mean over groups and its contrasts shrink differently."""
    _, networks, groups = logits.shape
    of_group = logits.mean(axis=1)
    noise = rng.standard_normal(of_group.shape)
    mean = np.zeros_like(of_group)
    for part, variance in (
        (_level, (groups * sigma**2 + tau**2) / networks),
        (_contrast, tau**2 / networks),
    ):
        kept = MEAN_SD**2 / (MEAN_SD**2 + variance)
        mean += kept[:, None] * part(of_group)
        mean += np.sqrt(kept * variance)[:, None] * part(noise)
    return mean


def _level(values: FloatArray) -> FloatArray:
    return np.broadcast_to(values.mean(axis=1, keepdims=True), values.shape)


def _contrast(values: FloatArray) -> FloatArray:
    return values - values.mean(axis=1, keepdims=True)


def _of_new_networks(
    rng: np.random.Generator,
    mean: FloatArray,
    sigma: FloatArray,
    tau: FloatArray,
    tables: Sequence[FloatArray],
) -> FloatArray:
    """Return probabilities of printed counts by pairs of new networks, ``(draw, pair, group)``."""
    draws, groups = mean.shape
    network = rng.standard_normal((draws, _PAIRS, 2, 1)) * sigma[:, None, None, None]
    rest = rng.standard_normal((draws, _PAIRS, 2, groups)) * tau[:, None, None, None]
    step = _PAIR_GRID[1] - _PAIR_GRID[0]
    place = (mean[:, None, None, :] + network + rest - _PAIR_GRID[0]) / step
    place = np.clip(place, 0.0, _PAIR_GRID.size - 1.0)
    cell = np.minimum(place.astype(np.int64), _PAIR_GRID.size - 2)
    share = place - cell
    of_group = np.empty((draws, _PAIRS, groups))
    for group, table in enumerate(tables):
        (row, column), (down, right) = (
            np.moveaxis(values[..., group], 2, 0) for values in (cell, share)
        )
        of_group[..., group] = (1 - down) * (
            (1 - right) * table[row, column] + right * table[row, column + 1]
        ) + down * ((1 - right) * table[row + 1, column] + right * table[row + 1, column + 1])
    return of_group


def _ratio(sums: FloatArray) -> tuple[float, float]:
    """Return log(Σ weight · probability / Σ weight) and its standard error, over batches."""
    weight, together = sums[:, 0], sums[:, 1]
    if together.sum() <= 0:
        return -np.inf, np.inf
    ratio = together.sum() / weight.sum()
    if len(sums) < 2:
        return np.log(ratio), np.inf
    scatter = np.std(together - ratio * weight, ddof=1) * np.sqrt(len(sums))
    return np.log(ratio), scatter / together.sum()
