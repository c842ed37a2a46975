"""The paper's claims, one by one, against a run: what it says, what we find, and a verdict.

The rules for verdicts were written before any run at the paper's scale was looked at; see
``docs/adr/0032-verdicts-on-claims.md``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from surmount.analysis.result import Analysis
from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.report.comparison import Comparison
from surmount.report.document.text import (
    counted,
    listed,
    number,
    percent,
    percent_interval,
    significant,
    variant_range,
)
from surmount.report.evidence import Findings
from surmount.report.outcomes import Outcomes
from surmount.report.verdicts import (
    NO_DIFFERENCE,
    NOT_TESTABLE,
    UNTRAINED,
    Claim,
    Verdict,
    time_verdict,
)
from surmount.stats.bootstrap import Bootstrap
from surmount.stats.detectable import detectable_between
from surmount.stats.differences import network_difference
from surmount.stats.evidence import bootstrap_interval
from surmount.stats.proportions import proportion_test
from surmount.studies.paper.results import (
    SURVIVAL_CLAIM,
    PaperGroup,
    PaperResult,
    paper_result,
)
from surmount.workflow.run_layout import ARMS, INITIATION

NEAR = 0.10
"""Success rates this near count as partly the same."""
MASTERED, UNLEARNT = 0.95, 0.05
"""From here on hardly anything is left to gain, and up to here hardly anything was learnt."""
SEED = 0
"""Seed of the bootstrap over networks."""


def claims_of(task: str, findings: Findings) -> tuple[Claim, ...]:
    """Go through every claim of the paper on an obstacle; none where there are none."""
    paper, analysis, tests = paper_result(task), findings.analysis, findings.tests
    if paper is None or analysis is None:
        return ()
    sizes_mm = analysis.variants[:, 0]
    groups = [group for group in paper.groups if group.holds(sizes_mm).any()]
    claims = [_groups(paper, analysis), _levels(paper, analysis)]
    if INITIATION in tests:
        claims += [_initiation(group, tests[INITIATION]) for group in groups]
    of_arms: list[Claim] = []
    if all(arm in tests for arm in ARMS):
        before = tests.get(INITIATION)
        of_arms += [_success(group, tests[ARMS[0]], tests[ARMS[1]], before) for group in groups]
    if findings.comparison is not None:
        of_arms.append(_survival(findings.comparison))
    if analysis.curriculum.n_levels == 0:
        of_arms = [_untrained(claim) for claim in of_arms]
    return (*claims, *of_arms)


def _untrained(claim: Claim) -> Claim:
    """Return a claim about two arms of which neither has left the initial network."""
    return replace(claim, verdict="open", reason=UNTRAINED)


# Grouping --------------------------------------------------------------------------------------


def _groups(paper: PaperResult, analysis: Analysis) -> Claim:
    sizes_mm = analysis.variants[:, 0]
    ours = listed(
        [f"{g.name} {variant_range(analysis.parameters, g.variants)}" for g in analysis.groups]
    )
    known = all(group.recovered for group in paper.groups)
    theirs = listed(
        [
            f"{g.name} {g.range_mm[0]:g}–{g.range_mm[1]:g} mm" if known else g.name
            for g in paper.groups
        ]
    )
    same_number = len(paper.groups) == len(analysis.groups)
    if not known:
        verdict: Verdict = "reproduced" if same_number else "not reproduced"
        reason = "The paper does not say which variants its groups hold: only their number counts."
    else:
        moved = _moved(_labels(paper, sizes_mm), _own_labels(analysis))
        verdict = "not reproduced"
        if same_number:
            verdict = "reproduced" if moved < len(paper.groups) else "partly"
        reason = (
            f"{counted(moved, 'variant')} of {sizes_mm.size} would have to change group; up to one "
            "for each boundary counts as the same."
        )
    return Claim(claim="groups", paper=theirs, ours=ours, verdict=verdict, reason=reason)


def _labels(paper: PaperResult, sizes_mm: FloatArray) -> IntArray:
    inside: list[BoolArray] = [group.holds(sizes_mm) for group in paper.groups]
    return np.argmax(inside, axis=0).astype(np.int64)


def _own_labels(analysis: Analysis) -> IntArray:
    return analysis.curriculum.groups_of(analysis.variants)


def _moved(first: IntArray, second: IntArray) -> int:
    """Return how many variants two groupings place apart, under the best match of their groups."""
    table = np.zeros((int(first.max()) + 1, int(second.max()) + 1), dtype=np.int64)
    np.add.at(table, (first, second), 1)
    matched = linear_sum_assignment(table, maximize=True)
    return int(first.size - table[matched].sum())


def _levels(paper: PaperResult, analysis: Analysis) -> Claim:
    levels = analysis.curriculum.n_levels
    return Claim(
        claim="levels",
        paper=str(paper.levels),
        ours=str(levels),
        verdict="reproduced" if levels == paper.levels else "not reproduced",
        reason="Groups below "
        f"{percent(analysis.curriculum.success_threshold)} success after the initiation get one.",
    )


# Success ---------------------------------------------------------------------------------------


def _rates(outcomes: Outcomes, group: PaperGroup) -> FloatArray:
    """Return each network's success on each of the group's variants, ``(network, variant)``."""
    sizes, networks = np.unique(outcomes.variant[:, 0]), np.unique(outcomes.network)
    inside = sizes[group.holds(sizes)]
    return np.array(
        [
            [
                outcomes.success[
                    (outcomes.network == network) & (outcomes.variant[:, 0] == size)
                ].mean()
                for size in inside
            ]
            for network in networks
        ]
    )


def _initiation(group: PaperGroup, outcomes: Outcomes) -> Claim:
    rates = _rates(outcomes, group)
    found = bootstrap_interval(rates, Bootstrap(seed=SEED), statistic=_mean)
    apart = abs(found.estimate - group.after_initiation)
    inside = (
        found.lower is not None
        and found.upper is not None
        and found.lower <= group.after_initiation <= found.upper
    )
    verdict: Verdict = "reproduced" if inside else "partly" if apart <= NEAR else "not reproduced"
    return Claim(
        claim=f"success after the initiation, {_where(group)}",
        paper=percent(group.after_initiation),
        ours=f"{percent(found.estimate)} ({percent_interval(found.lower, found.upper)})",
        verdict=verdict,
        reason=f"95 % bootstrap interval over {counted(rates.shape[0], 'network')}; partly means "
        f"within {100 * NEAR:.0f} points.",
    )


def _mean(scores: FloatArray) -> float:
    return float(scores.mean())


def _success(
    group: PaperGroup, curriculum: Outcomes, control: Outcomes, before: Outcomes | None
) -> Claim:
    arms = (curriculum, control)
    inside = [group.holds(outcomes.variant[:, 0]) for outcomes in arms]
    won = [int(outcomes.success[mask].sum()) for outcomes, mask in zip(arms, inside, strict=True)]
    tried = [int(mask.sum()) for mask in inside]
    test = proportion_test(won, tried)
    difference = network_difference(*(_rates(outcomes, group) for outcomes in arms), paired=True)
    rates = [successes / trials for successes, trials in zip(won, tried, strict=True)]
    sure = difference.lower is not None and difference.lower > 0
    ahead = rates[0] > rates[1]
    verdict: Verdict
    if group.more_successes:
        shown = significant(test.p_value) and ahead
        verdict = "reproduced" if shown and sure else "partly" if shown else "not reproduced"
    else:
        verdict = "not reproduced" if significant(test.p_value) else "reproduced"
    p = "no test" if test.p_value is None else f"χ² = {number(test.statistic, 4)}"
    limits = percent_interval(difference.lower, difference.upper).replace("%", "points")
    found = detectable_between(
        np.subtract(*(_rates(outcomes, group).mean(axis=1) for outcomes in arms))
    )
    least = "" if found is None else f"; {100 * found:.0f} would have been found"
    return Claim(
        claim=f"success with and without curriculum, {_where(group)}",
        paper=_printed(group),
        ours=f"{won[0]} / {tried[0]} against {won[1]} / {tried[1]}, {p}; over networks "
        f"{100 * difference.estimate:+.0f} points ({limits}{least})".replace("-", "\N{MINUS SIGN}"),
        verdict=verdict,
        reason=_why(rates, None if before is None else float(_rates(before, group).mean())),
    )


def _printed(group: PaperGroup) -> str:
    counts = ""
    if group.curriculum is not None and group.control is not None:
        counts = f" ({_count(group.curriculum)} against {_count(group.control)})"
    return ("more successes with it" if group.more_successes else "no difference") + counts


def _count(counts: tuple[int, int]) -> str:
    return f"{counts[0]} / {counts[1]}"


def _why(rates: list[float], before: float | None) -> str:
    begun = "" if before is None else f" (after the initiation {percent(before)})"
    if min(rates) >= MASTERED:
        return f"Both arms master the group{begun}: there is nothing left to gain."
    if max(rates) <= UNLEARNT:
        return f"Neither arm learns the group within these steps{begun}."
    gap = rates[0] - rates[1]
    if abs(gap) <= UNLEARNT:
        return f"Both arms get equally far{begun}."
    return f"{'The curriculum' if gap > 0 else 'The control'} gets further{begun}."


def _where(group: PaperGroup) -> str:
    low, high = group.range_mm
    return f"{group.name} ({low:g}–{high:g} mm{'' if group.recovered else ', assumed'})"


# Completion times ------------------------------------------------------------------------------


def _survival(comparison: Comparison) -> Claim:
    verdicts = [time_verdict(entry.log_rank) for entry in comparison.groups]
    sooner = sum(verdict.startswith("sooner") for verdict in verdicts)
    later = sum(verdict.startswith("later") for verdict in verdicts)
    verdict: Verdict = "not reproduced"
    if all(found == NOT_TESTABLE for found in verdicts):
        verdict = "open"
    elif sooner == len(verdicts):
        verdict = "reproduced"
    elif sooner > later:
        verdict = "partly"
    return Claim(
        claim="completion time",
        paper=SURVIVAL_CLAIM,
        ours="; ".join(
            f"{entry.group}: {found if found != NO_DIFFERENCE else 'no difference'}"
            for entry, found in zip(comparison.groups, verdicts, strict=True)
        ),
        verdict=verdict,
        reason="Log-rank tests over trials in our own groups. They take the trials of one network "
        "for independent, which they are not.",
    )
