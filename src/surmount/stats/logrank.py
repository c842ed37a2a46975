"""The log-rank test for equal completion times in two or more groups (paper III-E).

SciPy's ``logrank`` takes two groups and keeps the expected counts to itself, so that it serves as
an oracle of the tests only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc  # the tail of χ²

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.errors import InputError
from surmount.stats.columns import Labels, labels, require_same_length
from surmount.stats.result import Result
from surmount.stats.survival import survival_columns


@dataclass(frozen=True, kw_only=True)
class LogRank(Result):
    """Test of equal completion times.

    Attributes
    ----------
    groups
        Labels of the groups, ascending.
    n_trials, observed
        Trials and finished trials of each group.
    expected
        Finished trials of each group if all groups were alike; a group with more observed than
        expected finishes sooner.
    statistic, degrees_of_freedom, p_value
        χ², its degrees of freedom, and the p-value; ``None`` where undefined.
    reason
        Why they are undefined, if they are.
    """

    groups: tuple[str, ...]
    n_trials: tuple[int, ...]
    observed: tuple[int, ...]
    expected: tuple[float, ...]
    statistic: float | None
    degrees_of_freedom: int | None
    p_value: float | None
    reason: str | None


def log_rank(time: object, event: object, group: object) -> LogRank:
    """Compare completion times between groups, as R's ``survival::survdiff`` does.

    Parameters
    ----------
    time
        Completion time of each trial, or the cap where it failed, shape ``(trial,)``.
    event
        Whether the trial finished (true, 1) or was censored (false, 0), shape ``(trial,)``.
    group
        Label of each trial's group, shape ``(trial,)``.

    Returns
    -------
    LogRank
        Statistic and p-value, or the reason why there are none.
    """
    measured, happened = survival_columns(time, event)
    grouped = labels(group, "group")
    require_same_length(time=measured, group=grouped.codes)
    if len(grouped.names) < 2:
        raise InputError(
            f"The log-rank test compares groups, but there is only `{''.join(grouped.names)}`.",
            remedy="Give trials of at least two groups.",
        )
    at_risk, finished = _tally(measured, happened, grouped)
    expected, covariance = _moments(at_risk, finished)
    observed = finished.sum(axis=0)
    statistic = degrees = p_value = None
    # The deviations sum to 0, so one group of those ever at risk is redundant.
    keep = np.flatnonzero(expected > 0)[1:]
    kept = covariance[np.ix_(keep, keep)]
    if not happened.any():
        reason = "No trial finished in any group, so there is nothing to compare."
    elif keep.size == 0 or int(np.linalg.matrix_rank(kept)) < keep.size:
        reason = (
            "Some groups were never at risk together while a trial finished, so their completion "
            "times cannot be compared."
        )
    else:
        reason = None
        deviation = (observed - expected)[keep]
        statistic = float(deviation @ np.linalg.solve(kept, deviation))
        degrees = int(keep.size)
        p_value = float(chdtrc(degrees, statistic))
    return LogRank(
        groups=grouped.names,
        n_trials=tuple(np.bincount(grouped.codes).tolist()),
        observed=tuple(int(count) for count in observed),
        expected=tuple(expected.tolist()),
        statistic=statistic,
        degrees_of_freedom=degrees,
        p_value=p_value,
        reason=reason,
    )


def _tally(time: FloatArray, event: BoolArray, group: Labels) -> tuple[FloatArray, FloatArray]:
    """Count the trials at risk and finished in each group at each time with a finished trial.

    Returns
    -------
    tuple
        Two arrays of shape ``(time, group)``.
    """
    distinct, index = np.unique(time, return_inverse=True)
    leaving = np.zeros((distinct.size, len(group.names)))
    finished = np.zeros_like(leaving)
    np.add.at(leaving, (index, group.codes), 1.0)
    np.add.at(finished, (index, group.codes), event)
    at_risk = leaving[::-1].cumsum(axis=0)[::-1]
    happens = finished.any(axis=1)
    return at_risk[happens], finished[happens]


def _moments(at_risk: FloatArray, finished: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the hypergeometric mean and covariance of finished trials under equality.

    Parameters
    ----------
    at_risk, finished
        Trials at risk and finished at each event time, shape ``(time, group)``.

    Returns
    -------
    tuple
        Expected counts of shape ``(group,)``, covariance of shape ``(group, group)``.
    """
    all_at_risk, all_finished = at_risk.sum(axis=1), finished.sum(axis=1)
    share = at_risk / all_at_risk[:, None]
    spread = all_finished * (all_at_risk - all_finished) / np.maximum(all_at_risk - 1, 1)
    covariance = np.diag(spread @ share) - np.einsum("t,ti,tj->ij", spread, share, share)
    return all_finished @ share, covariance
