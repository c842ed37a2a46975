"""Success rates: intervals for one, and the test for equality of two (paper III-E)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from scipy.special import ndtri

from surmount.core.arrays import IntArray
from surmount.core.errors import InputError
from surmount.stats.columns import counts, require_confidence, require_same_length
from surmount.stats.result import Result

SMALL_EXPECTED_COUNT = 5.0
"""Below this expected count in any of the four cells the χ² law is a poor approximation."""


@dataclass(frozen=True, kw_only=True)
class ProportionTest(Result):
    """Test of equal success rates in two arms.

    Attributes
    ----------
    successes, totals
        Successful and all trials of the first and the second arm.
    proportions
        Success rate of each arm.
    difference, difference_lower, difference_upper
        First rate minus second, with its interval; the limits are ``None`` where undefined.
    confidence
        Confidence level of the interval.
    statistic, degrees_of_freedom, p_value
        χ² with continuity correction, its degrees of freedom, and the two-sided p-value.
    small_expected_counts
        Whether an expected count is below 5, so that the p-value is only roughly right.
    reason
        Why statistic, p-value and interval are undefined, if they are.
    """

    successes: tuple[int, int]
    totals: tuple[int, int]
    proportions: tuple[float, float]
    difference: float
    difference_lower: float | None
    difference_upper: float | None
    confidence: float
    statistic: float | None
    degrees_of_freedom: int
    p_value: float | None
    small_expected_counts: bool
    reason: str | None


@dataclass(frozen=True, kw_only=True)
class ProportionIntervals(Result):
    """Success rates with Wilson's score intervals, one entry per row given.

    Attributes
    ----------
    proportions, lower, upper
        Rate and limits of each row.
    confidence
        Confidence level of the intervals.
    """

    proportions: tuple[float, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    confidence: float


def _trial_counts(successes: object, totals: object) -> tuple[IntArray, IntArray]:
    won, tried = counts(successes, "successes"), counts(totals, "totals")
    require_same_length(successes=won, totals=tried)
    if (tried == 0).any():
        raise InputError(
            f"An arm has no trials: totals are {tried.tolist()}.",
            remedy="Give arms with at least one trial each.",
        )
    if (won > tried).any():
        raise InputError(
            f"There are more successes ({won.tolist()}) than trials ({tried.tolist()}).",
            remedy="Give the number of successful trials first, then the number of all trials.",
        )
    return won, tried


def proportion_test(
    successes: object, totals: object, *, confidence: float = 0.95
) -> ProportionTest:
    """Test whether two arms have the same success rate, as R's ``prop.test`` does.

    Pearson's χ² on the 2 × 2 table with Yates' continuity correction, which is never larger than
    the difference it corrects; the interval is Wald's, widened by the same correction. Both treat
    trials as independent, which trials of one network are not: see the evidence over networks.

    Parameters
    ----------
    successes, totals
        Successful and all trials of the two arms, two counts each.
    confidence
        Confidence level of the interval of the difference.

    Returns
    -------
    ProportionTest
        Statistic, p-value and interval, or the reason why there are none: where all trials of
        both arms ended alike, the pooled rate has no variance.
    """
    from scipy.stats import chi2_contingency  # noqa: PLC0415 - slow to import
    from scipy.stats.contingency import expected_freq  # noqa: PLC0415 - slow to import

    require_confidence(confidence)
    won, tried = _trial_counts(successes, totals)
    if won.size != 2:
        raise InputError(
            f"The proportion test compares two arms, not {won.size}.",
            remedy="Give two success counts and two totals.",
        )
    rate = won / tried
    difference = float(rate[0] - rate[1])
    outcomes = np.stack([won, tried - won])
    statistic = p_value = lower = upper = reason = None
    if won.sum() in (0, tried.sum()):
        outcome = "succeeded" if won.any() else "failed"
        reason = (
            f"Every trial of both arms {outcome}: the pooled rate has no variance, so neither "
            "statistic nor interval is defined."
        )
    else:
        # SciPy's result class is made at import, out of sight of type checkers.
        test = cast(Any, chi2_contingency(outcomes, correction=True))
        statistic, p_value = float(test.statistic), float(test.pvalue)
        error = float(np.sqrt((rate * (1 - rate) / tried).sum()))
        correction = min(0.5 * float((1 / tried).sum()), abs(difference))
        width = float(ndtri((1 + confidence) / 2)) * error + correction
        lower, upper = max(difference - width, -1.0), min(difference + width, 1.0)
    return ProportionTest(
        successes=(int(won[0]), int(won[1])),
        totals=(int(tried[0]), int(tried[1])),
        proportions=(float(rate[0]), float(rate[1])),
        difference=difference,
        difference_lower=lower,
        difference_upper=upper,
        confidence=confidence,
        statistic=statistic,
        degrees_of_freedom=1,
        p_value=p_value,
        small_expected_counts=bool((expected_freq(outcomes) < SMALL_EXPECTED_COUNT).any()),
        reason=reason,
    )


def proportion_intervals(
    successes: object, totals: object, *, confidence: float = 0.95
) -> ProportionIntervals:
    """Return success rates with Wilson's score intervals, for curves of success over variants.

    The interval inverts the score test of one proportion (E. B. Wilson, J. Am. Stat. Assoc. 22,
    1927), so it stays inside [0, 1] and has a width at rates of 0 and 1, where Wald's has none.

    Parameters
    ----------
    successes, totals
        Successful and all trials, one count per row.
    confidence
        Confidence level.
    """
    from scipy.stats import binomtest  # noqa: PLC0415 - slow to import

    require_confidence(confidence)
    won, tried = _trial_counts(successes, totals)
    intervals = [
        binomtest(k, n).proportion_ci(confidence, method="wilson")
        for k, n in zip(won.tolist(), tried.tolist(), strict=True)
    ]
    return ProportionIntervals(
        proportions=tuple((won / tried).tolist()),
        lower=tuple(float(interval.low) for interval in intervals),
        upper=tuple(float(interval.high) for interval in intervals),
        confidence=confidence,
    )
