"""The answer to "does the curriculum help?", by networks, and what it rests on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surmount.analysis.result import Analysis
from surmount.analysis.trust import is_stable
from surmount.core.arrays import BoolArray, FloatArray
from surmount.report.document.text import SPACE, counted, percent, percent_interval, signed
from surmount.report.outcomes import Outcomes, arm_differences
from surmount.report.results import RunResults
from surmount.stats.detectable import detectable_between
from surmount.stats.differences import NetworkDifference
from surmount.workflow.run_layout import ARMS, CURRICULUM, INITIATION

Help = Literal["helps", "harms", "not shown", "nothing to add", "nothing to compare", "open"]
"""What a run says to it: not shown where the interval over networks holds zero, or there is none;
nothing to add where every trial of both arms succeeds; nothing to compare where the arms are one
treatment; open before both arms were tested."""

OPENING: dict[Help, str] = {
    "helps": "Yes, the curriculum helps",
    "harms": "No, the curriculum harms",
    "not shown": "It is not shown that the curriculum helps",
    "nothing to add": "The curriculum had nothing to add",
    "nothing to compare": "Whether the curriculum helps cannot be asked here",
    "open": "Whether the curriculum helps is still to come",
}


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What a run says to the question, and the sentences that say it.

    Attributes
    ----------
    verdict
        In one word.
    effect
        Difference of mean success with its interval, in points; empty where there is none.
    networks
        How many networks are ahead with the curriculum; empty likewise.
    sentences
        The first answers; the others say what it rests on.
    """

    verdict: Help
    effect: str
    networks: str
    sentences: tuple[str, ...]


def answer(results: RunResults) -> Answer:
    """Answer from a run, as far as it has come."""
    analysis, comparison = results.analysis, results.comparison
    if analysis is None or comparison is None:
        rest = () if analysis is None else (_stability(analysis),)
        return Answer(verdict="open", effect="", networks="",
                      sentences=(f"{OPENING['open']}.", *rest))  # fmt: skip
    decided = _levels(results)
    if not analysis.curriculum.levels or len(analysis.groups) == 1:
        why = (
            "there is one group, and its one level draws what the control draws"
            if analysis.curriculum.levels
            else "every group succeeds already, and neither arm was trained any further"
        )
        sentence = f"{OPENING['nothing to compare']}: {why}."
        return Answer(verdict="nothing to compare", effect="", networks="",
                      sentences=(sentence, _stability(analysis), *decided))  # fmt: skip
    if all(results.tests[arm].success.all() for arm in ARMS):
        before = results.tests[INITIATION].success.mean()
        sentence = (
            f"{OPENING['nothing to add']}: in the end every trial succeeds, with it and without "
            f"({percent(before)} before)."
        )
        return Answer(verdict="nothing to add", effect="", networks="",
                      sentences=(sentence, _stability(analysis), *decided))  # fmt: skip
    mean = comparison.mean_difference
    found = _verdict(mean)
    differences = network_differences(results)
    effect, ahead = _effect(mean), _ahead(differences)
    sentence = f"{OPENING[found]}: mean success differs by {effect}"
    sentence += f" (with it minus without; paired t-test over networks); {ahead}."
    if found == "not shown":
        sentence += _would_have_been_found(differences)
    if mean.lower is None and mean.reason:
        sentence += f" {mean.reason}"
    return Answer(
        verdict=found,
        effect=effect,
        networks=ahead,
        sentences=(sentence, _stability(analysis), *decided),
    )


def _verdict(mean: NetworkDifference) -> Help:
    if mean.lower is None or mean.upper is None:
        return "not shown"
    if mean.lower > 0:
        return "helps"
    return "harms" if mean.upper < 0 else "not shown"


def _effect(mean: NetworkDifference) -> str:
    estimate = f"{signed(round(100 * mean.estimate, 1))}{SPACE}points"
    if mean.lower is None or mean.upper is None:
        return f"{estimate}, without an interval"
    limits = percent_interval(mean.lower, mean.upper, 0).replace("%", "points")
    return f"{estimate}, 95{SPACE}% interval {limits}"


def _would_have_been_found(differences: FloatArray) -> str:
    """Say what a paired t-test over as many networks could have found, where that is known."""
    least = detectable_between(differences)
    if least is None:
        return ""
    return (
        f" A difference of {100 * least:.0f}{SPACE}points would have been found in four of five "
        "such runs."
    )


def _ahead(differences: FloatArray) -> str:
    ahead, behind = int((differences > 0).sum()), int((differences < 0).sum())
    words = f"{ahead} of {counted(differences.size, 'network')} "
    words += "is ahead with it" if ahead == 1 else "are ahead with it"
    return words if ahead + behind == differences.size else f"{words}, {behind} behind"


def network_differences(results: RunResults, group: int | None = None) -> FloatArray:
    """Return each network's success with the curriculum minus without, ``(network,)``.

    Parameters
    ----------
    results
        Of a run with an analysis, whose tests are finished.
    group
        Of the variants of this group alone; of all if None.
    """
    return arm_differences(results.tests, lambda test: test.success, _chosen(results, group))


def time_differences(results: RunResults, group: int) -> FloatArray:
    """Return each network's mean completion time with the curriculum minus without, ``(network,)``.

    In s, over all trials of a group; a failed one counts as the longest of all trials.
    """
    longest = max(float(results.tests[arm].end_s.max()) for arm in ARMS)
    return arm_differences(
        results.tests,
        lambda test: np.where(test.success, test.end_s, longest),
        _chosen(results, group),
    )


def _chosen(results: RunResults, group: int | None) -> Callable[[Outcomes], BoolArray]:
    """Return what chooses the trials of a group; of all if None."""
    assert results.analysis is not None  # noqa: S101 - asked where there are groups
    curriculum = results.analysis.curriculum
    if group is None:
        return lambda test: np.ones(test.success.size, dtype=np.bool_)
    return lambda test: curriculum.groups_of(test.variant) == group


def _stability(analysis: Analysis) -> str:
    """Say whether the groups come back when trials are drawn again."""
    stable, stability = is_stable(analysis), analysis.stability
    if stability is None:
        return "How sure the grouping is was not assessed."
    again = (
        f"with trials drawn again there were {counted(len(analysis.groups), 'group')} as here in "
        f"{percent(stability.same_count)} of {stability.replicates} replicates"
    )
    return f"The grouping is {'stable' if stable else 'not stable'}: {again}."


def _levels(results: RunResults) -> list[str]:
    """Say how levels ended: by what eq. 5 found, or at the limit of their extensions."""
    ends = Counter(
        test.decision
        for training in results.trainings[CURRICULUM].values()
        for test in training.level_tests
        if test.decision != "extend"
    )
    if not ends:
        return []
    total = sum(ends.values())
    passed = total - ends["advance at the limit"]
    sentence = (
        f"Of {counted(total, 'level')} that ended over all networks, {passed} "
        f"{'was' if passed == 1 else 'were'} passed because reward grew no further (eq. 5), and "
        f"{total - passed} left at the limit of extensions."
    )
    return [sentence]
