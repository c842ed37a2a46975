"""Section: both arms tested, by the statistics of the paper."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from surmount.analysis.result import Analysis
from surmount.report.comparison import Comparison, GroupComparison
from surmount.report.document.parts import Block, Column, Notice, Paragraph, Section, Table
from surmount.report.document.text import (
    SPACE,
    UNDEFINED,
    interval,
    listed,
    name_and_unit,
    number,
    p_value,
    percent_interval,
    signed,
)
from surmount.report.figures.palette import ARM_STYLES
from surmount.report.figures.path import path_lengths
from surmount.report.figures.success import success_by_group
from surmount.report.figures.survival import survival_curves
from surmount.report.figures.variant import success_by_variant
from surmount.report.outcomes import Outcomes, arm_differences
from surmount.report.verdicts import (
    NOT_TESTABLE,
    UNTRAINED,
    because,
    path_verdict,
    success_verdict,
    time_verdict,
)
from surmount.stats.mixed import MethodContrast
from surmount.stats.survival import KaplanMeier
from surmount.tasks.curriculum import Curriculum
from surmount.workflow.run_layout import ARMS


def testing_section(
    analysis: Analysis | None, comparison: Comparison | None, tests: Mapping[str, Outcomes]
) -> Section:
    """Show success, completion times and path lengths of both arms."""
    blocks: list[Block] = []
    if analysis is not None and comparison is not None:
        if analysis.curriculum.n_levels == 0:
            both = "Both arms are the networks after the initiation: what differs is chance."
            blocks.append(Notice(title="Nothing to compare", sentences=(UNTRAINED, both)))
        blocks += [
            success_by_group(comparison, analysis.curriculum, tests),
            success_table(comparison),
            survival_curves(comparison),
            survival_table(comparison),
        ]
    else:
        blocks.append(
            Notice(
                title="Not there yet",
                sentences=(
                    (
                        "The run has not reached the statistics: success and completion times of "
                        "both arms cannot be compared."
                    ),
                ),
            )
        )
    figure = None if analysis is None else path_lengths(analysis.curriculum, tests)
    if figure is not None:
        blocks.append(figure)
    if analysis is not None and comparison is not None:
        blocks += path_table(comparison, analysis.curriculum, tests)
        blocks.append(success_by_variant(comparison, analysis.curriculum))
    return Section(
        anchor="testing", title="Testing: curriculum against control", blocks=tuple(blocks)
    )


def success_table(comparison: Comparison) -> Table:
    """Return the proportion test of each group."""
    tests = [entry.proportion_test for entry in comparison.groups]
    small = [
        entry.group
        for entry in comparison.groups
        if entry.proportion_test.small_expected_counts and entry.proportion_test.p_value is not None
    ]
    notes = [
        (
            "Continuity-corrected χ² test with one degree of freedom, as R's prop.test; "
            "difference: curriculum minus control."
        ),
        *dict.fromkeys(test.reason for test in tests if test.reason),
    ]
    if small:
        named = listed([f"“{name}”" for name in small])
        notes.append(
            f"In {named} an expected count is below 5: there the p-value is only roughly right."
        )
    return Table(
        label="",
        title="Success of both arms per group",
        columns=(
            Column(heading="group"),
            *(Column(heading=ARM_STYLES[arm].name, numeric=True) for arm in ARMS),
            Column(heading="difference (points)", numeric=True),
            Column(heading="95 % interval", numeric=True),
            Column(heading="χ²", numeric=True),
            Column(heading="p", numeric=True),
            Column(heading="result"),
        ),
        rows=tuple(_success_row(entry) for entry in comparison.groups),
        notes=tuple(notes),
    )


def _success_row(entry: GroupComparison) -> tuple[str, ...]:
    test = entry.proportion_test
    return (
        entry.group,
        *(f"{entry.arms[arm].successes} / {entry.arms[arm].trials}" for arm in ARMS),
        signed(100 * test.difference),
        percent_interval(test.difference_lower, test.difference_upper, 1).removesuffix(f"{SPACE}%"),
        number(test.statistic, 4),
        _p(test.p_value),
        success_verdict(test),
    )


def _p(p: float | None) -> str:
    return (
        UNDEFINED
        if p is None
        else p_value(p).replace(SPACE, " ").removeprefix("p = ").removeprefix("p ")
    )


def survival_table(comparison: Comparison) -> Table:
    """Return median completion times and the log-rank test of each group."""
    rows = tuple(
        (
            entry.group,
            *(_median(entry.survival[arm]) for arm in ARMS),
            number(entry.log_rank.statistic, 4),
            _p(entry.log_rank.p_value),
            time_verdict(entry.log_rank),
        )
        for entry in comparison.groups
    )
    return Table(
        label="",
        title="Completion times of both arms per group",
        columns=(
            Column(heading="group"),
            *(Column(heading=f"median, {ARM_STYLES[arm].name} (s)", numeric=True) for arm in ARMS),
            Column(heading="χ²", numeric=True),
            Column(heading="p", numeric=True),
            Column(heading="result"),
        ),
        rows=rows,
        notes=(
            (
                "Medians by Kaplan and Meier with 95 % intervals, over all trials, failed ones "
                f"censored at {comparison.cap_s:g} s; {UNDEFINED} where fewer than half finish, or "
                "the limit does not exist. The test takes trials of one network as independent, "
                "which they are not: one network can make a difference."
            ),
            *dict.fromkeys(
                entry.log_rank.reason for entry in comparison.groups if entry.log_rank.reason
            ),
        ),
    )


def _median(curve: KaplanMeier) -> str:
    if curve.median is None:
        return UNDEFINED
    low, high = (
        UNDEFINED if limit is None else f"{limit:.2f}"
        for limit in (curve.median_lower, curve.median_upper)
    )
    return f"{curve.median:.2f} ({low} to {high})"


def path_table(
    comparison: Comparison, curriculum: Curriculum, tests: Mapping[str, Outcomes]
) -> list[Block]:
    """Return the contrasts of path lengths beside their spread over networks, for all paths."""
    rows: list[tuple[str, ...]] = []
    reasons: dict[str | None, None] = {}
    notes = [
        (
            "Linear mixed model by REML, group × method with a random intercept per initial "
            "network (III-E); difference: curriculum minus control, in degrees. The model knows "
            "no network that takes to the method otherwise than the rest: one network can make a "
            "difference. By network: the smallest and the largest difference of a network's means."
        )
    ]
    for path, model in comparison.path_lengths.items():
        name = name_and_unit(path)[0]
        rows += [
            _contrast_row(name, contrast, _spread(path, contrast.group, curriculum, tests))
            for contrast in model.contrasts
        ]
        reasons |= dict.fromkeys(c.reason for c in model.contrasts if c.reason)
        if model.degrees_of_freedom_rule:
            notes.append(
                f"{name}: degrees of freedom by {model.degrees_of_freedom_rule}; interaction of "
                f"group and method: {_interaction(comparison, path)}."
            )
        if model.singular_note:
            notes.append(f"{name}: {model.singular_note}")
        if model.reason and not model.contrasts:
            reasons[model.reason] = None
    notes += [reason for reason in reasons if reason]
    if not rows:
        return [Paragraph(text=" ".join(notes))]
    table = Table(
        label="",
        title="Path lengths: curriculum against control",
        columns=(
            Column(heading="path"),
            Column(heading="group"),
            Column(heading="difference (°)", numeric=True),
            Column(heading="95 % interval", numeric=True),
            Column(heading="by network", numeric=True),
            Column(heading="s.e.", numeric=True),
            Column(heading="d.f.", numeric=True),
            Column(heading="t", numeric=True),
            Column(heading="p", numeric=True),
            Column(heading="result"),
        ),
        rows=tuple(rows),
        notes=tuple(notes),
    )
    return [table]


def _spread(path: str, group: str, curriculum: Curriculum, tests: Mapping[str, Outcomes]) -> str:
    """Return the range of networks' differences in mean path length over successful trials."""
    index = [one.name for one in curriculum.groups].index(group)
    differences = arm_differences(
        tests,
        lambda test: test.path_lengths[path],
        lambda test: test.success & (curriculum.groups_of(test.variant) == index),
    )
    differences = differences[np.isfinite(differences)]
    return interval(differences.min(), differences.max()) if differences.size else UNDEFINED


def _contrast_row(name: str, contrast: MethodContrast, spread: str) -> tuple[str, ...]:
    return (
        name,
        contrast.group,
        signed(contrast.estimate),
        interval(contrast.lower, contrast.upper),
        spread,
        number(contrast.std_error),
        number(contrast.degrees_of_freedom),
        number(contrast.t),
        _p(contrast.p_value),
        path_verdict(contrast),
    )


def _interaction(comparison: Comparison, path: str) -> str:
    found = comparison.path_lengths[path].interaction
    if found is None or found.statistic is None:
        return because(NOT_TESTABLE, None, None if found is None else found.reason)
    return (
        f"F = {number(found.statistic)} on {found.numerator_df} and "
        f"{number(found.denominator_df)} degrees of freedom, {p_value(found.p_value)}"
    )
