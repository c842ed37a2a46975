"""Section: what networks, rather than their trials, tell about both arms."""

from __future__ import annotations

from collections.abc import Sequence

from surmount.analysis.result import Analysis
from surmount.report.comparison import Comparison
from surmount.report.document.parts import Block, Column, Paragraph, Section, Table
from surmount.report.document.text import (
    UNDEFINED,
    integer,
    percent,
    percent_interval,
    reached,
    signed,
)
from surmount.report.evidence import Evidence
from surmount.report.figures.palette import ARM_STYLES
from surmount.report.figures.profile import profiles
from surmount.stats.evidence import SeedInterval
from surmount.workflow.run_layout import ARMS


def evidence_section(
    analysis: Analysis | None, comparison: Comparison | None, evidence: Evidence
) -> Section | None:
    """Show what the networks, rather than their trials, tell; ``None`` before the statistics."""
    if analysis is None or comparison is None:
        return None
    text = (
        "The tests above take every trial as an independent draw. Whether another training run "
        f"would show the same is a question about networks, of which there are "
        f"{comparison.difference.n_networks[0]} here. Below ten, the bootstrap's intervals are too "
        "narrow; the paired t-test's is the one to trust."
    )
    blocks: list[Block] = [Paragraph(text=text), _network_table(comparison)]
    if evidence.profiles:
        blocks.append(profiles(evidence.profiles))
    blocks.append(speed_table(analysis, comparison))
    return Section(anchor="evidence", title="Evidence over networks", blocks=tuple(blocks))


def _network_table(comparison: Comparison) -> Table:
    mean = comparison.mean_difference
    estimate = f"{signed(100 * mean.estimate)} points"
    limits = UNDEFINED
    if mean.lower is not None and mean.upper is not None:
        limits = percent_interval(mean.lower, mean.upper, 1).replace("%", "points")
    rows = [
        ("mean success, curriculum − control, paired t-test", estimate, limits),
        *(
            evidence_row(
                f"success, interquartile mean, {ARM_STYLES[arm].name}",
                comparison.interquartile_mean[arm],
            )
            for arm in ARMS
        ),
        evidence_row("interquartile mean, curriculum − control", comparison.difference, "points"),
        evidence_row("probability of improvement", comparison.probability_of_improvement),
    ]
    reasons = dict.fromkeys(
        found.reason for found in (mean, comparison.difference) if found.reason is not None
    )
    note = (
        "Percentile bootstrap over whole networks, each keeping its success rates on all "
        f"variants; {comparison.difference.resamples:,} resamples. Probability of "
        "improvement: that a network with the curriculum beats one without on a variant, "
        "ties counted half; 50 % means no difference."
    )
    return evidence_table("Success over networks", rows, (note, *reasons))


def evidence_table(title: str, rows: Sequence[tuple[str, ...]], notes: Sequence[str]) -> Table:
    """Return a table of measures with their estimates and intervals."""
    return Table(
        label="",
        title=title,
        columns=(
            Column(heading="measure"),
            Column(heading="estimate", numeric=True),
            Column(heading="95 % interval", numeric=True),
        ),
        rows=tuple(rows),
        notes=tuple(notes),
    )


def speed_table(analysis: Analysis, comparison: Comparison) -> Table:
    """Return when each group's training episodes succeeded in 95 % of cases, by arm."""
    rows = [
        (
            group.name,
            ARM_STYLES[arm].name,
            reached(found.n_reached, found.n_networks, found.median_steps),
            *(UNDEFINED if steps is None else integer(round(steps)) for steps in found.first_steps),
        )
        for index, group in enumerate(analysis.curriculum.groups)
        for arm in ARMS
        for found in (comparison.steps_to_95[arm][index],)
    ]
    return Table(
        label="",
        title="Learning steps until 95 % of a group's training episodes succeed",
        columns=(
            Column(heading="group"),
            Column(heading="arm"),
            Column(heading="got there", numeric=True),
            *(
                Column(heading=f"network {index}", numeric=True)
                for index in range(comparison.difference.n_networks[0])
            ),
        ),
        rows=tuple(rows),
        notes=(
            (
                "After the initiation; of the group's newest episodes in training, with random "
                "starts and exploration, on the tasks that the arm sampled within the group. "
                "Networks that get there, and the median over all by Kaplan and Meier. Looked at "
                "40 times: the first figure is the least there can be."
            ),
        ),
    )


def evidence_row(name: str, found: SeedInterval, unit: str = "%") -> tuple[str, str, str]:
    """Return a row of a table: name, estimate and interval."""
    values = (percent(found.estimate, 1), percent_interval(found.lower, found.upper, 1))
    estimate, limits = (value.replace("%", unit) for value in values)
    return name, estimate, limits
