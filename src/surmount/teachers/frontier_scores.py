"""The numbers of the frontier teacher as free functions of arrays."""

from __future__ import annotations

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.teachers.cell_groups import CellGroups
from surmount.teachers.frontier_config import FrontierConfig
from surmount.teachers.success_guided import guided_weights


def success_bounds(
    successes: FloatArray, episodes: FloatArray, tail: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return mean, lower and upper bound of success after a uniform prior, each ``(group,)``.

    Parameters
    ----------
    successes, episodes
        Discounted counts, ``(group,)``.
    tail
        Probability below the lower and above the upper bound.
    """
    from scipy.special import betaincinv  # noqa: PLC0415 - slow; not for a list of teachers

    good, bad = successes + 1.0, episodes - successes + 1.0
    low, high = betaincinv(good, bad, tail), betaincinv(good, bad, 1.0 - tail)
    return good / (good + bad), np.asarray(low), np.asarray(high)


def worth(success: FloatArray, config: FrontierConfig) -> FloatArray:
    """Return k(p): 1 at the target, little where nothing or everything succeeds."""
    shape = (config.target, config.sharpness, config.floor)
    return guided_weights(success, *shape) / guided_weights(np.array(config.target), *shape)


def cell_success(
    successes: FloatArray, episodes: FloatArray, group_success: FloatArray, shrinkage: float
) -> FloatArray:
    """Return each cell's success, mixed with its group's as with so many episodes, ``(variant,)``.

    Parameters
    ----------
    successes, episodes
        Discounted counts of each cell, ``(variant,)``.
    group_success
        Success of the group of each cell, ``(variant,)``.
    shrinkage
        m.
    """
    return (successes + shrinkage * group_success) / (episodes + shrinkage)


def novelty(group_episodes: FloatArray) -> FloatArray:
    """Return √(ln(1 + ΣE) / (1 + E_g)), large of groups hardly tried, ``(group,)``."""
    return np.sqrt(np.log1p(group_episodes.sum()) / (1.0 + group_episodes))


def by_way_covered(covered: FloatArray) -> FloatArray:
    """Return 1 / rank of the share of the way covered, the farthest first, ``(group,)``.

    Equal shares have equal values; where nothing is known (NaN) all are alike.
    """
    if np.isnan(covered).any():
        return np.ones(covered.size)
    farther = (covered[None, :] > covered[:, None] + 1e-12).sum(axis=1)
    return 1.0 / (1.0 + farther)


def frontier_weights(
    groups: CellGroups,
    values: FloatArray,
    cell_worth: FloatArray,
    mastered: BoolArray,
    rehearsed: BoolArray,
    config: FrontierConfig,
) -> FloatArray:
    """Return the probability of each cell, ``(variant,)``: uniform, rehearsal and frontier.

    Parameters
    ----------
    groups
        The cells.
    values
        Of each group, ``(group,)``.
    cell_worth
        k(p) of each cell, ``(variant,)``.
    mastered, rehearsed
        Groups that are no frontier, and groups to rehearse; ``(group,)``.
    config
        Shares.
    """
    count = groups.cells.count
    uniform_share, rehearsal_share = config.uniform_share, config.rehearsal_share
    frontier_share = 1.0 - uniform_share - rehearsal_share
    if mastered.all():
        frontier_share, rehearsal_share = 0.0, frontier_share + rehearsal_share
    if not rehearsed.any():
        uniform_share, rehearsal_share = uniform_share + rehearsal_share, 0.0
    weights = np.full(count, uniform_share / count)
    if rehearsal_share:
        own = rehearsed[groups.group]
        weights[own] += rehearsal_share / own.sum()
    if frontier_share:
        shares = np.where(mastered, 0.0, values)
        shares = frontier_share * shares / shares.sum()
        within = cell_worth / groups.totals(cell_worth)[groups.group]
        weights = weights + shares[groups.group] * within
    return _capped(groups, weights, config.most_of_one_group)


def _capped(groups: CellGroups, weights: FloatArray, most: float) -> FloatArray:
    """Take from a group what exceeds the largest share, and spread it over all other cells."""
    totals = groups.totals(weights)
    largest = int(totals.argmax())
    if totals.size == 1 or totals[largest] <= most:
        return weights
    own = groups.group == largest
    capped = np.where(own, weights * most / totals[largest], weights)
    capped[~own] += (totals[largest] - most) / (~own).sum()
    return capped
