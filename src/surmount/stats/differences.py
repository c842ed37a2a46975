"""The difference between two arms over networks by Student's t, which holds with few networks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import FloatArray
from surmount.stats.columns import ROUNDING, require_confidence
from surmount.stats.result import Result
from surmount.stats.strata import flat, read_two_arms, sizes, too_few


@dataclass(frozen=True, kw_only=True)
class NetworkDifference(Result):
    """Difference of mean scores between two arms, with networks as the only repetitions.

    Attributes
    ----------
    estimate
        Mean score of the first arm minus that of the second.
    lower, upper
        Limits of its interval, ``None`` where undefined.
    t, degrees_of_freedom, p_value
        Two-sided t-test that it is zero; ``None`` where undefined.
    confidence
        Confidence level of the interval.
    paired
        Whether networks were compared pair by pair.
    n_networks
        Networks in each arm.
    reason
        Why limits and test are undefined, if they are.
    """

    estimate: float
    lower: float | None
    upper: float | None
    t: float | None
    degrees_of_freedom: float | None
    p_value: float | None
    confidence: float
    paired: bool
    n_networks: tuple[int, ...]
    reason: str | None


def network_difference(
    first: npt.ArrayLike, second: npt.ArrayLike, *, paired: bool, confidence: float = 0.95
) -> NetworkDifference:
    """Compare two arms by the mean score of each network.

    Each network's scores are averaged over variants first, so that only networks count as
    repetitions. Pairs are compared by the paired t-test, independent arms by Welch's.

    Parameters
    ----------
    first, second
        Scores of the arms, shape ``(network, variant)`` or ``(network,)``.
    paired
        Whether row i of both arms grew from the same initial network (as in the paper).
    confidence
        Confidence level of the interval.
    """
    from scipy.stats import ttest_ind, ttest_rel  # noqa: PLC0415 - slow to import

    require_confidence(confidence)
    one, two = read_two_arms({"first": first}, {"first": second}, paired=paired)
    reason = too_few(one, two)
    means = [matrix.mean(axis=1) for arm in (one, two) for matrix in arm.values()]
    estimate = float(flat(one, None).mean() - flat(two, None).mean())
    if reason is None and _vary_by_rounding_alone(means[0], means[1], paired=paired):
        reason = (
            "All networks of an arm score alike, or all pairs differ by the same amount, so there "
            "is no variance between networks to judge the difference by."
        )
    lower = upper = t = degrees = p_value = None
    if reason is None:
        # SciPy's result class is made at import, out of sight of type checkers.
        test = cast(Any, ttest_rel(*means) if paired else ttest_ind(*means, equal_var=False))
        interval = test.confidence_interval(confidence)
        lower, upper = float(interval.low), float(interval.high)
        t, degrees, p_value = float(test.statistic), float(test.df), float(test.pvalue)
    return NetworkDifference(
        estimate=estimate,
        lower=lower,
        upper=upper,
        t=t,
        degrees_of_freedom=degrees,
        p_value=p_value,
        confidence=confidence,
        paired=paired,
        n_networks=sizes(one, two),
        reason=reason,
    )


def _vary_by_rounding_alone(first: FloatArray, second: FloatArray, *, paired: bool) -> bool:
    largest = float(max(np.abs(first).max(), np.abs(second).max()))
    spreads = [np.ptp(first - second)] if paired else [np.ptp(first), np.ptp(second)]
    return float(max(spreads)) <= ROUNDING * largest
