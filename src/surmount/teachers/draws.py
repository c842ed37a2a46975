"""Tasks drawn by hand, the same however often a teacher was saved and taken up again."""

from __future__ import annotations

from surmount.core.arrays import FloatArray
from surmount.core.seeds import generator
from surmount.tasks.distribution import TaskDistribution


class Draws:
    """Draws from a teacher's distribution.

    Each call has a generator of its own, derived from the seed and the number of calls before it,
    so this number is all there is to save.

    Attributes
    ----------
    calls
        Calls made so far.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self.calls = 0

    def draw(self, distribution: TaskDistribution, k: int) -> FloatArray:
        """Draw ``k`` tasks, shape ``(k, parameter)``."""
        rng = generator(self._seed, "sample", self.calls)
        self.calls += 1
        return distribution.sample(rng, k)
