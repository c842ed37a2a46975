"""Learning steps needed to a success rate, with networks that never get there counted as such."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import BoolArray
from surmount.core.errors import InputError
from surmount.stats.columns import numbers
from surmount.stats.result import Result
from surmount.stats.survival import kaplan_meier


@dataclass(frozen=True, kw_only=True)
class StepsToThreshold(Result):
    """Learning steps until a success rate is reached, network by network.

    Attributes
    ----------
    threshold
        Success rate to reach, a fraction.
    first_steps
        Steps at each network's first evaluation that reaches it; ``None`` if none does.
    lasting_steps
        Steps at the first evaluation from which on all reach it; ``None`` if the last does not.
    n_networks, n_reached
        Networks in all, and those that reach it at least once.
    last_steps
        Steps at the last evaluation: those not there yet need more than this.
    median_steps, median_lower, median_upper
        Median of ``first_steps`` over networks with its interval, by Kaplan and Meier, so that
        networks not there yet count as needing more than ``last_steps``.
    confidence
        Confidence level of the interval.
    reason
        Which numbers are ``None`` and why, or ``None`` if none is.
    """

    threshold: float
    first_steps: tuple[float | None, ...]
    lasting_steps: tuple[float | None, ...]
    n_networks: int
    n_reached: int
    last_steps: float
    median_steps: float | None
    median_lower: float | None
    median_upper: float | None
    confidence: float
    reason: str | None


def steps_to_threshold(
    steps: npt.ArrayLike,
    success: npt.ArrayLike,
    *,
    threshold: float = 0.95,
    confidence: float = 0.95,
) -> StepsToThreshold:
    """Find how many learning steps each network needs to a success rate.

    Only evaluated step counts are reported, without interpolation: between two evaluations nothing
    was measured.

    Parameters
    ----------
    steps
        Learning steps at each evaluation, ascending, shape ``(evaluation,)``.
    success
        Success rate at each evaluation as a fraction, shape ``(network, evaluation)``, or
        ``(evaluation,)`` for one network.
    threshold
        Success rate to reach, a fraction.
    confidence
        Confidence level of the median's interval.
    """
    counted = numbers(steps, "steps")
    rates = np.atleast_2d(np.asarray(success))
    if rates.ndim != 2 or rates.shape[1] != counted.size:
        raise InputError(
            f"`success` has shape {rates.shape}, but there are {counted.size} evaluations.",
            remedy="Give one row per network and one column per evaluation.",
        )
    rates = numbers(rates.ravel(), "success").reshape(rates.shape)
    if (np.diff(counted) <= 0).any() or (counted < 0).any():
        raise InputError(
            "`steps` must be non-negative and ascend from one evaluation to the next.",
            remedy="Sort the evaluations by their learning steps.",
        )
    if (rates < 0).any() or (rates > 1).any() or not 0 < threshold <= 1:
        raise InputError(
            f"Success rates ({rates.min():g} to {rates.max():g}) and threshold ({threshold:g}) "
            "must be fractions.",
            remedy="Divide percentages by 100.",
        )
    reached = rates >= threshold
    # Looking back from the end: reached at this evaluation and at all later ones.
    lasting = np.logical_and.accumulate(reached[:, ::-1], axis=1)[:, ::-1]
    first = _first(counted.tolist(), reached)
    last = float(counted[-1])
    waiting = kaplan_meier(
        [last if value is None else value for value in first],
        [value is not None for value in first],
        confidence=confidence,
    )
    n_reached = int(reached.any(axis=1).sum())
    return StepsToThreshold(
        threshold=threshold,
        first_steps=first,
        lasting_steps=_first(counted.tolist(), lasting),
        n_networks=len(first),
        n_reached=n_reached,
        last_steps=last,
        median_steps=waiting.median,
        median_lower=waiting.median_lower,
        median_upper=waiting.median_upper,
        confidence=confidence,
        reason=_reason(len(first), n_reached, threshold, last)
        if None in (*first, waiting.median, waiting.median_lower, waiting.median_upper)
        else None,
    )


def _first(steps: list[float], reached: BoolArray) -> tuple[float | None, ...]:
    return tuple(steps[int(row.argmax())] if row.any() else None for row in reached)


def _reason(n_networks: int, n_reached: int, threshold: float, last: float) -> str:
    return (
        f"{n_reached} of {n_networks} networks reach {threshold:.0%} within {last:,.0f} steps; a "
        "median, or a limit of its interval, is missing where that is too few to tell it."
    )
