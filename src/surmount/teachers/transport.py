"""Optimal transport between equally many particles, and how far along it they may go."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surmount.core.arrays import FloatArray, IntArray

_GRID = 33
"""Places along each particle's way at which performance is looked at, both ends among them."""
_BISECTIONS = 50


def matching(sources: FloatArray, targets: FloatArray) -> tuple[IntArray, IntArray]:
    """Return the pairs with the least sum of squared distances; each row is used at most once.

    Parameters
    ----------
    sources, targets
        Shapes ``(source, parameter)`` and ``(target, parameter)``.

    Returns
    -------
    tuple
        Rows of sources and of targets, as many as the smaller has.
    """
    from scipy.optimize import linear_sum_assignment  # noqa: PLC0415 - slow; not for a list

    cost = np.square(sources[:, None, :] - targets[None, :, :]).sum(axis=2)
    rows, columns = linear_sum_assignment(cost)
    return np.asarray(rows, dtype=np.int64), np.asarray(columns, dtype=np.int64)


def moved_towards(
    particles: FloatArray,
    targets: FloatArray,
    sound: Callable[[FloatArray], FloatArray],
    bound: float,
    step_rms: float,
) -> FloatArray:
    """Return particles moved along their ways to their targets, as far as they may.

    Minimises the mean squared distance that is left, such that every particle stays where it is
    sound and the root mean square of the moves is at most ``step_rms``. The multiplier of the
    second bound makes the shares of their ways alike for all that are not held by the first, so the
    solution is found by one bisection.

    Parameters
    ----------
    particles, targets
        In pairs, each of shape ``(particle, parameter)``.
    sound
        Gives the performance of points, ``(point, parameter)`` to ``(point,)``.
    bound
        A particle stays where its performance is at least this; one that is below it already stays.
    step_rms
        Largest root mean square of the moves.
    """
    ways = targets - particles
    shares = np.linspace(0.0, 1.0, _GRID)
    points = particles[:, None, :] + shares[None, :, None] * ways[:, None, :]
    performance = sound(points.reshape(-1, particles.shape[1])).reshape(len(particles), _GRID)
    # The farthest place before the first one that is not sound.
    reached = np.cumprod(performance >= bound, axis=1).sum(axis=1)
    farthest = shares[np.maximum(reached - 1, 0)]
    squared = np.square(ways).sum(axis=1)

    def rms(share: float) -> float:
        return float(np.sqrt((np.minimum(farthest, share) ** 2 * squared).mean()))

    low, high = 0.0, 1.0
    if rms(high) > step_rms:
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if rms(middle) > step_rms else (middle, high)
    else:
        low = high
    return particles + np.minimum(farthest, low)[:, None] * ways
