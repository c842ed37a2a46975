"""What the tests allow to be said, in one wording everywhere, and never more than that."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from surmount.core.arrays import FloatArray
from surmount.report.comparison import GroupComparison
from surmount.report.document.text import p_value, signed, significant
from surmount.stats.logrank import LogRank
from surmount.stats.mixed import MethodContrast
from surmount.stats.proportions import ProportionTest
from surmount.stats.result import Result
from surmount.workflow.run_layout import ARMS

NOT_TESTABLE = "not testable"
NO_DIFFERENCE = "no difference shown"
UNTRAINED = "The curriculum has no levels: neither arm was trained any further."

Verdict = Literal["reproduced", "partly", "not reproduced", "open"]


@dataclass(frozen=True, kw_only=True)
class Claim(Result):
    """One claim of a paper and what a run says to it.

    Attributes
    ----------
    claim
        What it is about.
    paper, ours
        What the paper prints and what the run shows, in words.
    verdict
        ``"open"`` where the run has not come so far, or there is nothing to compare.
    reason
        What the verdict rests on.
    """

    claim: str
    paper: str
    ours: str
    verdict: Verdict
    reason: str


def success_verdict(test: ProportionTest) -> str:
    """Say whether success differs between curriculum (first) and control (second)."""
    if test.p_value is None:
        return NOT_TESTABLE
    if not significant(test.p_value):
        return NO_DIFFERENCE
    return f"{'more' if test.difference > 0 else 'fewer'} successes with the curriculum"


def time_verdict(test: LogRank) -> str:
    """Say whether trials finish sooner with the curriculum than in the control."""
    if test.p_value is None:
        return NOT_TESTABLE
    if not significant(test.p_value):
        return NO_DIFFERENCE
    mine = test.groups.index(ARMS[0])
    sooner = test.observed[mine] > test.expected[mine]
    return f"{'sooner' if sooner else 'later'} with the curriculum"


def path_verdict(contrast: MethodContrast) -> str:
    """Say whether path lengths differ between curriculum and control."""
    if contrast.p_value is None or contrast.estimate is None:
        return NOT_TESTABLE
    if not significant(contrast.p_value):
        return NO_DIFFERENCE
    return f"{'shorter' if contrast.estimate < 0 else 'longer'} with the curriculum"


def because(verdict: str, p: float | None, reason: str | None) -> str:
    """Return a verdict with its p-value, or with the reason why there is none."""
    if p is not None:
        return f"{verdict} ({p_value(p)})"
    words = (reason or "").rstrip(". ")
    return f"{verdict} ({words[:1].lower()}{words[1:]})" if words else verdict


def group_sentence(entry: GroupComparison, differences: FloatArray, times: FloatArray) -> str:
    """Say in one sentence what is found in one group.

    Tests over trials take trials of one network for independent. They are told where all networks
    agree with them; where networks disagree, or some
    are alike, that is what is said.

    Parameters
    ----------
    entry
        The group.
    differences
        Success of each network with the curriculum minus without, shape ``(network,)``.
    times
        The same of its mean completion time in s.
    """
    success, time = entry.proportion_test, entry.log_rank
    head = f"Group “{entry.group}”, curriculum against control: "
    ahead, behind = int((differences > 0).sum()), int((differences < 0).sum())
    if ahead and behind:
        return (
            f"{head}networks disagree, {ahead} of {differences.size} ahead and {behind} behind; "
            f"their mean difference is {signed(round(100 * float(differences.mean()), 1))} points."
        )
    if 0 < ahead + behind < differences.size:
        alike = differences.size - ahead - behind
        by_success = f"{ahead} of {differences.size} networks ahead, {behind} behind, {alike} alike"
    else:
        by_success = because(success_verdict(success), success.p_value, success.reason)
    sooner, later = int((times < 0).sum()), int((times > 0).sum())
    if sooner and later:
        by_time = f"networks disagree, {sooner} of {times.size} sooner and {later} later with it"
    else:
        by_time = because(time_verdict(time), time.p_value, time.reason)
    return f"{head}success: {by_success}; completion time: {by_time}."
