"""Evidence over networks: what would change had other seeds been drawn.

Tests on trials treat the trials of one network as independent draws; the claim that a curriculum
helps is about networks yet to be trained. These measures resample whole networks, following
Agarwal et al., "Deep reinforcement learning at the edge of the statistical precipice" (NeurIPS
2021), with one difference: that paper redraws the runs of each task independently, which fits
benchmarks where each task has its own runs. Here one network is tested on all variants, so its
row of scores is kept whole, and only strata with networks of their own (obstacles) are redrawn
independently.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.result import Result
from surmount.stats.strata import Scores, drawn, flat, read_strata, read_two_arms, sizes, too_few

Statistic = Callable[[FloatArray], float]
"""A summary of all scores, given as one flat array of shape ``(score,)``."""


@dataclass(frozen=True, kw_only=True)
class SeedInterval(Result):
    """An estimate with its percentile bootstrap interval over networks.

    Attributes
    ----------
    estimate
        Value for the networks at hand.
    lower, upper
        Limits, ``None`` where undefined.
    confidence, resamples
        Confidence level, and number of bootstrap resamples behind the limits.
    n_networks
        Networks in each stratum; of both arms, one after the other, where two are compared.
    reason
        Why the limits are undefined, if they are.
    """

    estimate: float
    lower: float | None
    upper: float | None
    confidence: float
    resamples: int
    n_networks: tuple[int, ...]
    reason: str | None


def interquartile_mean(scores: Scores) -> float:
    """Return the mean of the middle half: a quarter of the scores, rounded down, is cut each side.

    Parameters
    ----------
    scores
        As in :func:`bootstrap_interval`; all entries count alike.
    """
    ascending = np.sort(flat(read_strata(scores, "scores"), None))
    cut = ascending.size // 4
    return float(ascending[cut : ascending.size - cut].mean())


def _interval(
    estimate: float,
    draw: Callable[[np.random.Generator], float],
    bootstrap: Bootstrap,
    *arms: Mapping[str, FloatArray],
) -> SeedInterval:
    reason = too_few(*arms)
    lower = upper = None
    if reason is None:
        lower, upper = (float(limit) for limit in bootstrap.limits(draw))
    return SeedInterval(
        estimate=estimate,
        lower=lower,
        upper=upper,
        confidence=bootstrap.confidence,
        resamples=bootstrap.resamples,
        n_networks=sizes(*arms),
        reason=reason,
    )


def bootstrap_interval(
    scores: Scores, bootstrap: Bootstrap, *, statistic: Statistic = interquartile_mean
) -> SeedInterval:
    """Estimate a summary of scores with a stratified bootstrap interval over networks.

    Parameters
    ----------
    scores
        One row per network and one column per variant; a mapping of such arrays where strata,
        for example obstacles, have networks of their own.
    bootstrap
        How networks are redrawn.
    statistic
        Summary of all scores together, a flat array.
    """
    strata = read_strata(scores, "scores")
    return _interval(
        statistic(flat(strata, None)),
        lambda rng: statistic(flat(strata, drawn(strata, rng))),
        bootstrap,
        strata,
    )


def difference_interval(
    first: Scores,
    second: Scores,
    bootstrap: Bootstrap,
    *,
    paired: bool,
    statistic: Statistic = interquartile_mean,
) -> SeedInterval:
    """Estimate the difference of a summary between two arms, first minus second.

    Parameters
    ----------
    first, second
        Scores of the arms, as in :func:`bootstrap_interval`.
    paired
        Whether row i of both arms grew from the same initial network (as in the paper); the
        pairs are then redrawn together.
    bootstrap, statistic
        As in :func:`bootstrap_interval`.
    """
    one, two = read_two_arms(first, second, paired=paired)

    def draw(rng: np.random.Generator) -> float:
        rows = drawn(one, rng)
        others = rows if paired else drawn(two, rng)
        return statistic(flat(one, rows)) - statistic(flat(two, others))

    return _interval(
        statistic(flat(one, None)) - statistic(flat(two, None)),
        draw,
        bootstrap,
        one,
        two,
    )


def probability_of_improvement(
    first: Scores, second: Scores, bootstrap: Bootstrap, *, paired: bool
) -> SeedInterval:
    """Estimate how probably a network of the first arm beats one of the second on a variant.

    P(X > Y) + ½ P(X = Y) over all pairs of networks of the two arms, averaged over variants: the
    Mann–Whitney statistic divided by the number of pairs.

    Parameters
    ----------
    first, second, paired
        As in :func:`difference_interval`; pairing changes the interval only.
    bootstrap
        As in :func:`bootstrap_interval`.
    """
    one, two = read_two_arms(first, second, paired=paired)
    wins = {key: _wins(one[key], two[key]) for key in one}
    weights = [matrix.shape[1] for matrix in one.values()]

    def draw(rng: np.random.Generator) -> float:
        rows = drawn(one, rng)
        others = rows if paired else drawn(two, rng)
        shares = [float(wins[key][np.ix_(rows[key], others[key])].mean()) for key in wins]
        return float(np.average(shares, weights=weights))

    return _interval(
        float(np.average([float(matrix.mean()) for matrix in wins.values()], weights=weights)),
        draw,
        bootstrap,
        one,
        two,
    )


def _wins(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the share of variants won by each network against each, ``(network, network)``."""
    return (0.5 + 0.5 * np.sign(first[:, None, :] - second[None, :, :])).mean(axis=2)
