"""Levels of a curriculum: mixtures of groups, each with one dominant group (paper eq. 4)."""

from __future__ import annotations

from collections.abc import Sequence

from surmount.analysis.configuration import AnalysisConfig
from surmount.tasks.curriculum import Level


def build_levels(
    names: Sequence[str], success_rates: Sequence[float], config: AnalysisConfig
) -> tuple[Level, ...]:
    """Return one level for each group below the success threshold, from easy to difficult.

    Parameters
    ----------
    names, success_rates
        Of the groups, from the highest success rate to the lowest.
    config
        Threshold and weights.
    """
    return tuple(
        Level(dominant=names[group], weights=level_weights(group, len(names), config))
        for group, rate in enumerate(success_rates)
        if rate < config.success_threshold
    )


def level_weights(dominant: int, n_groups: int, config: AnalysisConfig) -> tuple[float, ...]:
    """Return the weights wᵢ of eq. 4 for a level.

    The dominant group gets ``dominant_weight``. The rest goes to the easier groups against
    forgetting, ``harder_share`` of it to the harder ones; where one of these sides is empty the
    other takes its part, and a group alone takes everything. Within a side, weights fall
    linearly from its easiest group to its hardest: 2/3 and 1/3 for two groups.

    Parameters
    ----------
    dominant
        Index of the dominant group; groups go from easy to difficult.
    n_groups
        Number of groups.
    config
        ``dominant_weight`` and ``harder_share``.
    """
    n_easier, n_harder = dominant, n_groups - dominant - 1
    rest = 1.0 - config.dominant_weight
    harder_share = config.harder_share if n_easier else 1.0
    harder = rest * harder_share if n_harder else 0.0
    easier = rest - harder if n_easier else 0.0
    return (
        *_falling(easier, n_easier),
        round(1.0 - harder - easier, 12),
        *_falling(harder, n_harder),
    )


def _falling(total: float, count: int) -> list[float]:
    ranks = range(count, 0, -1)
    # Twelve digits: 0.3 stands as 0.3 in the file that people read.
    return [round(total * rank / sum(ranks), 12) for rank in ranks]
