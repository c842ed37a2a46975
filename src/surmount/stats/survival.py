"""Completion times with failures censored at the cap: the Kaplan–Meier curve (paper III-E).

The curve is SciPy's. Its limits are R's default, symmetric on the logarithmic scale, which SciPy
does not offer (it has the plain and the log-log scale, and no median), so they are computed here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.stats.columns import flags, require_confidence, require_same_length, times
from surmount.stats.result import Result

TOLERANCE = float(np.sqrt(np.finfo(np.float64).eps))
"""Times closer than this, absolutely or relative to their mean, count as one (as in R)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class KaplanMeier(Result):
    """Estimated probability that a trial is not finished yet, as a step function of time.

    Attributes
    ----------
    time
        Distinct times at which a trial finished or was censored, ascending, shape ``(time,)``.
    at_risk
        Trials neither finished nor censored just before each time, shape ``(time,)``.
    events, censored
        Trials finished and censored at each time, shape ``(time,)``.
    survival
        Value of the curve from each time on, shape ``(time,)``; it is 1 before the first.
    log_std_error
        Greenwood's standard error of the curve's logarithm; ``None`` where the curve is 0.
    lower, upper
        Pointwise interval, symmetric on the logarithmic scale; ``None`` where the curve is 0.
    confidence
        Confidence level of the intervals.
    n_trials, n_events
        Trials in all, and those that finished.
    median, median_lower, median_upper
        Time at which half of the trials are finished, with its interval: where the curve and its
        limits first reach one half. ``None`` where they do not.
    reason
        Which numbers are ``None`` and why, or ``None`` if none is.
    """

    time: FloatArray
    at_risk: IntArray
    events: IntArray
    censored: IntArray
    survival: FloatArray
    log_std_error: tuple[float | None, ...]
    lower: tuple[float | None, ...]
    upper: tuple[float | None, ...]
    confidence: float
    n_trials: int
    n_events: int
    median: float | None
    median_lower: float | None
    median_upper: float | None
    reason: str | None

    def survival_at(self, time: FloatArray) -> FloatArray:
        """Return the curve at any times, of the shape given; flat after the last time."""
        values = np.concatenate([[1.0], self.survival])
        return values[np.searchsorted(self.time, time, side="right")]

    def at_risk_at(self, time: FloatArray) -> IntArray:
        """Return the number at risk just before any times, of the shape given."""
        values = np.concatenate([self.at_risk, [0]])
        return values[np.searchsorted(self.time, time, side="left")]


def survival_columns(time: object, event: object) -> tuple[FloatArray, BoolArray]:
    """Return times, with rounding removed, and events, both of shape ``(trial,)``."""
    measured, happened = times(time, "time"), flags(event, "event")
    require_same_length(time=measured, event=happened)
    return merge_ties(measured), happened


def merge_ties(time: FloatArray) -> FloatArray:
    """Return times in which values that differ by rounding alone are equal.

    Ten steps of 0.1 s do not add up to 1.0 s in floating point. As ``survival::aeqSurv`` does,
    each run of times closer than :data:`TOLERANCE` to their neighbour takes its first value.
    """
    distinct = np.unique(time)
    gap = np.diff(distinct)
    joined = (gap <= TOLERANCE) | (gap <= TOLERANCE * distinct.mean())
    first = distinct[np.concatenate([[True], ~joined])]
    return first[np.searchsorted(first, time, side="right") - 1]


def kaplan_meier(time: object, event: object, *, confidence: float = 0.95) -> KaplanMeier:
    """Estimate the curve of trials not finished yet, as R's ``survival::survfit`` does.

    Parameters
    ----------
    time
        Completion time of each trial, or the cap where it failed, shape ``(trial,)``.
    event
        Whether the trial finished (true, 1) or was censored (false, 0), shape ``(trial,)``.
    confidence
        Confidence level of the intervals.

    Returns
    -------
    KaplanMeier
        Curve, intervals and median.
    """
    from scipy.stats import CensoredData, ecdf  # noqa: PLC0415 - slow to import

    require_confidence(confidence)
    measured, happened = survival_columns(time, event)
    distinct, index = np.unique(measured, return_inverse=True)
    leaving = np.bincount(index, minlength=distinct.size)
    events = np.bincount(index, weights=happened, minlength=distinct.size).astype(np.int64)
    at_risk = measured.size - np.concatenate([[0], np.cumsum(leaving)[:-1]])
    survival = ecdf(CensoredData.right_censored(measured, ~happened)).sf.probabilities
    alive = events < at_risk  # only the last time can have none left: the curve is 0 there
    rest = np.where(alive, at_risk - events, 1)
    greenwood = np.cumsum(events / (at_risk * rest)).astype(np.float64)
    error = np.sqrt(greenwood)  # of the curve's logarithm
    quantile = float(ndtri((1 + confidence) / 2))
    lower = survival * np.exp(-quantile * error)
    upper = np.minimum(survival * np.exp(quantile * error), 1.0)
    reached = [
        _first_half(curve[alive], distinct[alive], drops)
        for curve, drops in (
            (survival, None if alive[-1] else float(distinct[-1])),
            (lower, None),
            (upper, None),
        )
    ]
    n_events = int(events.sum())
    return KaplanMeier(
        time=distinct,
        at_risk=at_risk.astype(np.int64),
        events=events,
        censored=(leaving - events).astype(np.int64),
        survival=survival,
        log_std_error=_where(alive, error),
        lower=_where(alive, lower),
        upper=_where(alive, upper),
        confidence=confidence,
        n_trials=int(measured.size),
        n_events=n_events,
        median=reached[0],
        median_lower=reached[1],
        median_upper=reached[2],
        reason=_reason(n_events, reached, complete=not alive[-1]),
    )


def _where(defined: BoolArray, values: FloatArray) -> tuple[float | None, ...]:
    pairs = zip(values.tolist(), defined.tolist(), strict=True)
    return tuple(value if known else None for value, known in pairs)


def _first_half(curve: FloatArray, time: FloatArray, drops: float | None) -> float | None:
    """Return where a falling step function reaches one half.

    Where it rests exactly on one half, the middle of that step is taken, as R does; ``drops`` is
    the time at which the curve falls to 0, beyond the values given.
    """
    below = np.flatnonzero(curve < 0.5 + TOLERANCE)
    if below.size == 0:
        return drops
    first = below[0]
    if abs(curve[first] - 0.5) < TOLERANCE:
        lower = np.flatnonzero(curve < curve[first])
        end = float(time[lower[0]]) if lower.size else drops
        if end is not None:
            return (float(time[first]) + end) / 2
    return float(time[first])


def _reason(n_events: int, reached: list[float | None], *, complete: bool) -> str | None:
    if n_events == 0:
        return "No trial finished: the curve stays at 1, and there is no median."
    sentences: list[str] = []
    if reached[0] is None:
        sentences.append("The curve stays above one half, so there is no median.")
    limits = [
        name for name, value in zip(("lower", "upper"), reached[1:], strict=True) if value is None
    ]
    if limits:
        sentences.append(
            f"The median has no {' and no '.join(limits)} limit, because that limit of the curve "
            "stays above one half."
        )
    if complete:
        sentences.append(
            "The curve ends at 0, where its logarithm and with it the interval are undefined."
        )
    return " ".join(sentences) or None
