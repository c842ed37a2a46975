"""Exploration noise that is correlated over time, white at every single moment."""

from __future__ import annotations

import math

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray


class CorrelatedNoise:
    """An AR(1) process in each row, ε_t = ρ ε_{t−1} + √(1 − ρ²) ξ_t with ξ_t from N(0, 1).

    Every ε_t is N(0, 1), and k steps apart they are correlated by ρᵏ. As the marginal is that
    of white noise, so is the density of an action given its observation alone, which is what PPO
    compares (Hollenstein et al., AAAI 2024).

    Parameters
    ----------
    correlation
        ρ, from 0 (white) to below 1.
    newest
        ε of the step before, ``(row, action)``; None at the beginning.

    Attributes
    ----------
    newest
        ε of the newest step; None as long as there is none, and always if the noise is white.
    """

    def __init__(self, correlation: float, newest: FloatArray | None = None) -> None:
        self._correlation = correlation
        self._innovation = math.sqrt(1.0 - correlation**2)
        self.newest = newest

    def next(self, fresh: FloatArray, begins: BoolArray | None = None) -> FloatArray:
        """Return ε of the next step.

        Parameters
        ----------
        fresh
            Independent standard normal numbers, ``(row, action)``; taken as they are at an
            episode's first step, and always if the noise is white.
        begins
            Rows whose episode begins with this step, ``(row,)``; none if None.
        """
        if self._correlation == 0.0:
            return fresh
        if self.newest is None:
            self.newest = fresh.copy()
            return fresh
        noise = self._correlation * self.newest + self._innovation * fresh
        if begins is not None:
            noise = np.where(np.asarray(begins, dtype=np.bool_)[:, None], fresh, noise)
        self.newest = noise
        return noise
