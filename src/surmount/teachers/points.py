"""Tasks drawn from densities that are no boxes, as points within the range."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surmount.core.arrays import FloatArray

_ROUNDS = 20
"""Rounds of drawing anew what fell outside, before the rest is drawn uniformly."""


def points_within(
    draw: Callable[[int], FloatArray], size: int, rng: np.random.Generator
) -> FloatArray:
    """Draw points from a density cut off at the unit box.

    Parameters
    ----------
    draw
        Draws so many points of the whole density, shape ``(size, parameter)``.
    size
        Points wanted.
    rng
        Draws the rest uniformly where hardly any point of the density lies within.

    Returns
    -------
    FloatArray
        Shape ``(size, parameter)``, each coordinate from 0 to 1.
    """
    kept: list[FloatArray] = []
    missing = size
    for _ in range(_ROUNDS):
        points = draw(size)
        inside = points[((points >= 0) & (points <= 1)).all(axis=1)][:missing]
        kept.append(inside)
        missing -= len(inside)
        if missing == 0:
            break
    parameters = kept[0].shape[1]
    return np.concatenate([*kept, rng.random((missing, parameters))])
