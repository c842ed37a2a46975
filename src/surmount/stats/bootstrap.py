"""Redrawing whole networks to see what would change with others.

Percentile intervals from few networks are too narrow: of nominal 95 % intervals of a normal mean,
about 73, 83 and 90 % cover it with 3, 5 and 10 networks, and they have no width at all where all
networks score alike. For a difference of means, :func:`surmount.stats.network_difference` keeps
its level.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.core.seeds import generator
from surmount.stats.columns import require_confidence

_FEWEST_RESAMPLES = 100


@dataclass(frozen=True, kw_only=True)
class Bootstrap:
    """How often networks are redrawn, and how wide an interval is read off.

    Attributes
    ----------
    seed
        Root seed of the resampling.
    confidence
        Confidence level of the percentile interval.
    resamples
        How often networks are redrawn.

    Raises
    ------
    InputError
        If the level is not between 0 and 1, or there are too few resamples to read it off.
    """

    seed: int
    confidence: float = 0.95
    resamples: int = 2000

    def __post_init__(self) -> None:
        require_confidence(self.confidence)
        if self.resamples < _FEWEST_RESAMPLES:
            raise InputError(
                f"{self.resamples} bootstrap resamples say nothing about the ends of an interval.",
                remedy=f"Ask for at least {_FEWEST_RESAMPLES}.",
            )

    def limits(
        self, draw: Callable[[np.random.Generator], npt.ArrayLike]
    ) -> tuple[FloatArray, FloatArray]:
        """Return the percentile limits of a statistic that ``draw`` computes of redrawn scores."""
        rng = generator(self.seed, "stats", "bootstrap")
        values = np.array([draw(rng) for _ in range(self.resamples)])
        tail = (1 - self.confidence) / 2
        low, high = np.quantile(values, [tail, 1 - tail], axis=0)
        return low, high
