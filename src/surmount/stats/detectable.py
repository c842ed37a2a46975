"""What a paired t-test over networks could have found: the other half of every "not sure".

For a true difference δ between pairs whose differences have the standard deviation σ, the t of n
pairs follows the noncentral law with n − 1 degrees of freedom and noncentrality δ√n/σ. The power is
the probability that the two-sided test finds the difference *with its right sign*, as R's
``power.t.test(type = "paired")`` counts it.

The standard deviation observed in few networks is itself a guess: from 5 of them, the true one lies
between 0.6 and 2.9 times it in 95 of 100 cases, and the detectable difference with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.optimize import brentq
from scipy.special import nctdtr, stdtrit  # laws of t; scipy.stats is slow to import

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.stats.result import Result

MOST_NETWORKS = 1_000_000
"""More networks than this are not asked for."""

_NO_SPREAD = (
    "All pairs differ by the same amount, so there is no variance between networks to judge a "
    "difference by."
)


@dataclass(frozen=True, kw_only=True)
class DetectableDifference(Result):
    """The smallest true difference between two arms that a paired t-test finds often enough.

    Attributes
    ----------
    difference
        The difference, in units of the scores; ``None`` where undefined. One beyond the range of
        the scores says that no difference could have been found.
    sd
        Standard deviation over networks of the difference within pairs, as assumed.
    n_networks
        Pairs of networks.
    power
        Probability of finding it.
    level
        Two-sided level of the test.
    reason
        Why the difference is undefined, if it is.
    """

    difference: float | None
    sd: float
    n_networks: int
    power: float
    level: float
    reason: str | None


@dataclass(frozen=True, kw_only=True)
class NetworksNeeded(Result):
    """How many pairs of networks a paired t-test needs to find a difference often enough.

    Attributes
    ----------
    n_networks
        Pairs needed, at least 2; ``None`` where no number is given.
    difference, sd
        True difference and its standard deviation over networks, as assumed.
    power, level
        As in :class:`DetectableDifference`.
    reason
        Why no number is given, if none is.
    """

    n_networks: int | None
    difference: float
    sd: float
    power: float
    level: float
    reason: str | None


def paired_power(difference: float, sd: float, n_networks: int, *, level: float = 0.05) -> float:
    """Return how probably a paired t-test finds a true difference, with its right sign.

    Parameters
    ----------
    difference
        True difference between the arms, in units of the scores.
    sd
        Standard deviation of the difference within pairs, in the same units, above 0.
    n_networks
        Pairs of networks, at least 2.
    level
        Two-sided level of the test.
    """
    _require(sd, level=level)
    if sd == 0 or n_networks < 2:
        raise InputError(
            f"There is no t-test of {n_networks} pairs whose differences vary by {sd:g}.",
            remedy="Give at least two pairs and a standard deviation above 0.",
        )
    return _power(abs(difference) / sd * np.sqrt(n_networks), n_networks, level)


def detectable_difference(
    sd: float, n_networks: int, *, power: float = 0.8, level: float = 0.05
) -> DetectableDifference:
    """Find the smallest true difference that a paired t-test over networks would have found.

    Parameters
    ----------
    sd
        Standard deviation over networks of the difference within pairs, for example
        :attr:`surmount.stats.NetworkContrast.sd`, in units of the scores.
    n_networks
        Pairs of networks.
    power
        How probably it is found, above ``level``.
    level
        Two-sided level of the test.
    """
    _require(sd, level=level, power=power)
    difference = reason = None
    if n_networks < 2:
        reason = "There are fewer than two pairs of networks, so there is no test to find anything."
    elif sd == 0:
        reason = _NO_SPREAD
    else:

        def missing(noncentrality: float) -> float:
            return _power(noncentrality, n_networks, level) - power

        far = 1.0
        while missing(far) < 0:
            far *= 2
        root = cast(float, brentq(missing, 0.0, far, xtol=1e-12))
        difference = root * sd / float(np.sqrt(n_networks))
    return DetectableDifference(
        difference=difference,
        sd=sd,
        n_networks=n_networks,
        power=power,
        level=level,
        reason=reason,
    )


def networks_needed(
    difference: float, sd: float, *, power: float = 0.8, level: float = 0.05
) -> NetworksNeeded:
    """Find how many pairs of networks a paired t-test needs to find a true difference.

    Parameters
    ----------
    difference
        True difference between the arms, in units of the scores, not 0.
    sd, power, level
        As in :func:`detectable_difference`.
    """
    _require(sd, level=level, power=power)
    if not np.isfinite(difference) or difference == 0:
        raise InputError(
            f"No number of networks finds a difference of {difference:g}.",
            remedy="Give the smallest difference that would matter to you.",
        )
    needed = reason = None
    if sd == 0:
        reason = _NO_SPREAD
    elif paired_power(difference, sd, MOST_NETWORKS, level=level) < power:
        reason = (
            f"More than {MOST_NETWORKS:,} pairs of networks are needed: the difference is too "
            "small beside its standard deviation."
        )
    else:
        too_few, needed = 1, MOST_NETWORKS
        while needed - too_few > 1:  # power grows with the number of pairs
            middle = (too_few + needed) // 2
            if paired_power(difference, sd, middle, level=level) < power:
                too_few = middle
            else:
                needed = middle
    return NetworksNeeded(
        n_networks=needed, difference=difference, sd=sd, power=power, level=level, reason=reason
    )


def _power(noncentrality: float, n_networks: int, level: float) -> float:
    """Return P(T > t*) for T of the noncentral law and the two-sided test's critical t*."""
    critical = float(stdtrit(n_networks - 1, 1 - level / 2))
    # Where less than 1e-40 is left, the law's series may give up: NaN stands for 0.
    missed = float(nctdtr(n_networks - 1, noncentrality, critical))
    return 1.0 if np.isnan(missed) else 1.0 - missed


def _require(sd: float, *, level: float, power: float | None = None) -> None:
    if not (np.isfinite(sd) and sd >= 0):
        raise InputError(
            f"The standard deviation is {sd:g}.", remedy="Give a finite number from 0 on."
        )
    if not 0 < level < 1:
        raise InputError(
            f"The level of the test is {level:g}, which is not between 0 and 1.",
            remedy="Give a fraction such as 0.05.",
        )
    if power is not None and not level < power < 1:
        raise InputError(
            f"A power of {power:g} is not between the test's level, {level:g}, and 1.",
            remedy="Give a fraction such as 0.8.",
        )


def detectable_between(differences: FloatArray) -> float | None:
    """Return the smallest difference that as many pairs as these would have shown; None if unknown.

    Parameters
    ----------
    differences
        Of the two arms in each pair of networks, ``(network,)``.
    """
    if differences.size < 2:
        return None
    return detectable_difference(float(differences.std(ddof=1)), differences.size).difference
