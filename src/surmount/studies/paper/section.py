"""Section: the paper's own numbers for this obstacle beside those of the run."""

from __future__ import annotations

from collections.abc import Sequence

from surmount.analysis.result import Analysis
from surmount.report.comparison import Comparison, GroupComparison, Success
from surmount.report.document.parts import Block, Column, Notice, Paragraph, Section, Table
from surmount.report.document.text import (
    UNDEFINED,
    counted,
    integer,
    listed,
    number,
    percent,
    variant_range,
)
from surmount.report.results import RunResults
from surmount.report.verdicts import Claim, because, success_verdict, time_verdict
from surmount.studies.paper.results import (
    SOURCE,
    SURVIVAL_CLAIM,
    PaperGroup,
    paper_result,
)
from surmount.workflow.run_layout import ARMS, CONTROL, CURRICULUM, INITIATION

RULES = (
    "The rules for verdicts (ADR 32) were written before any run at the paper's scale; that claims "
    "on arms are open without levels was added after the first. They are kind to wide intervals: "
    "with few networks that differ much, many values would count as reproduced. “No difference” is "
    "judged over trials, a difference over networks as well."
)


def paper_section(results: RunResults) -> Section | None:
    """Put both results side by side; ``None`` where the paper has none on this obstacle."""
    folder, analysis, comparison = results.folder, results.analysis, results.comparison
    paper = paper_result(folder.task)
    if paper is None:
        return None
    rows: list[tuple[str, str, str]] = [
        ("networks per arm", str(paper.networks), str(folder.networks)),
        (
            "groups",
            listed([group.name for group in paper.groups]),
            UNDEFINED if analysis is None else listed([group.name for group in analysis.groups]),
        ),
        (
            "levels",
            str(paper.levels),
            UNDEFINED if analysis is None else str(analysis.curriculum.n_levels),
        ),
    ]
    if paper.first_level_steps is not None:
        rows.append(
            (
                "first level ended, steps in all",
                f"near {integer(paper.first_level_steps)}",
                _first_level(results),
            )
        )
    if paper.successes is not None:
        rows.append(("all groups: with and without", paper.successes, _all_groups(comparison)))
    for group in paper.groups:
        rows += _group_rows(group, analysis, comparison)
    times = (
        UNDEFINED
        if comparison is None
        else "; ".join(f"{entry.group}: {_times(entry)}" for entry in comparison.groups)
    )
    rows.append(("completion time", SURVIVAL_CLAIM, times))
    blocks: list[Block] = []
    if folder.preset == "smoke":
        blocks.append(
            Notice(
                title="Not a comparison of results",
                sentences=(
                    (
                        "This run is of smoke scale: a fraction of the paper's learning steps and "
                        "trials. Its numbers stand here only to show the form of the comparison; "
                        "they neither support nor contradict the paper."
                    ),
                ),
            )
        )
    table = Table(
        label="",
        title="The paper's result and this run's",
        columns=(Column(heading=""), Column(heading="the paper"), Column(heading="this run")),
        rows=tuple(rows),
        notes=(
            (
                f"Source: {SOURCE}; variants of its groups are recovered from its counts and χ² "
                "values. Groups are matched by name, not by their variants."
            ),
        ),
    )
    intro = Paragraph(
        text="The robot of the paper lives in another simulator, and several of its settings are "
        f"not printed; {counted(folder.networks, 'network')} per arm were trained here."
    )
    claims = results.evidence.claims
    tables = (claim_table(claims), table) if claims else (table,)
    return Section(anchor="paper", title="Beside the paper", blocks=(*blocks, intro, *tables))


def claim_table(claims: Sequence[Claim], title: str = "Claim by claim") -> Table:
    """Return the table of claims with their verdicts."""
    headings = ("claim", "the paper", "this run", "verdict", "because")
    return Table(
        label="",
        title=title,
        columns=tuple(Column(heading=heading) for heading in headings),
        rows=tuple((c.claim, c.paper, c.ours, c.verdict, c.reason) for c in claims),
        notes=(RULES,),
    )


def _group_rows(
    paper: PaperGroup, analysis: Analysis | None, comparison: Comparison | None
) -> list[tuple[str, str, str]]:
    ours = next((g for g in analysis.groups if g.name == paper.name), None) if analysis else None
    entry = (
        next((e for e in comparison.groups if e.group == paper.name), None) if comparison else None
    )
    absent = UNDEFINED if analysis is None else "no group of this name"
    span = absent
    if analysis is not None and ours is not None:
        span = f"{variant_range(analysis.parameters, ours.variants)} ({len(ours.variants)})"
    return [
        (f"{paper.name}: variants", _paper_range(paper, analysis), span),
        (
            f"{paper.name}: success after initiation",
            percent(paper.after_initiation),
            absent if ours is None else percent(ours.success_rate),
        ),
        (
            f"{paper.name}: with curriculum",
            _count(paper.curriculum),
            _ours(entry, CURRICULUM),
        ),
        (f"{paper.name}: without", _count(paper.control), _ours(entry, CONTROL)),
        (
            f"{paper.name}: test of success",
            ("more successes with curriculum" if paper.more_successes else "no difference")
            + ("" if paper.chi_square is None else f", χ² = {number(paper.chi_square, 5)}"),
            UNDEFINED if entry is None else _test(entry),
        ),
    ]


def _first_level(results: RunResults) -> str:
    """Return the least and the most learning steps at which networks left their first level."""
    ends = [
        results.trainings[INITIATION][network].total_steps + test.steps
        for network, training in results.trainings[CURRICULUM].items()
        for test in training.level_tests
        if test.level == 0 and test.decision != "extend"
    ]
    return f"{integer(min(ends))} to {integer(max(ends))}" if ends else UNDEFINED


def _all_groups(comparison: Comparison | None) -> str:
    if comparison is None:
        return UNDEFINED
    counts: list[str] = []
    for arm in ARMS:
        found = [entry.arms[arm] for entry in comparison.groups]
        counts.append(f"{sum(s.successes for s in found)} / {sum(s.trials for s in found)}")
    return " against ".join(counts)


def _paper_range(paper: PaperGroup, analysis: Analysis | None) -> str:
    if not paper.recovered:
        return "not known"
    low, high = paper.range_mm
    count = "" if analysis is None else f" ({int(paper.holds(analysis.variants[:, 0]).sum())})"
    return f"{low:g}–{high:g} mm{count}"


def _test(entry: GroupComparison) -> str:
    test = entry.proportion_test
    statistic = "" if test.statistic is None else f", χ² = {number(test.statistic, 5)}"
    return because(success_verdict(test), test.p_value, test.reason) + statistic


def _times(entry: GroupComparison) -> str:
    test = entry.log_rank
    return because(time_verdict(test), test.p_value, test.reason)


def _count(counts: tuple[int, int] | None) -> str:
    return (
        "not printed" if counts is None else _share(Success(successes=counts[0], trials=counts[1]))
    )


def _ours(entry: GroupComparison | None, arm: str) -> str:
    return UNDEFINED if entry is None else _share(entry.arms[arm])


def _share(success: Success) -> str:
    return f"{success.successes} / {success.trials} ({percent(success.rate, 1)})"
