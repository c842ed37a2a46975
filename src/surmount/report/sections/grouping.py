"""Section: how the variants were grouped, and the curriculum that follows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surmount.analysis.result import Analysis
from surmount.analysis.stability import Stability
from surmount.core.arrays import FloatArray
from surmount.report.document.parts import Block, Column, Fold, Notice, Paragraph, Section, Table
from surmount.report.document.text import (
    axis_label,
    counted,
    interval,
    listed,
    name_and_unit,
    number,
    percent,
    percent_interval,
    variant_label,
    variant_range,
)
from surmount.report.figures.fit import mixture_fit
from surmount.report.figures.grouping import distances_and_groups
from surmount.report.figures.stability import success_and_stability
from surmount.stats.proportions import proportion_intervals
from surmount.tasks.curriculum import Group

MOST_BOXES = 2
"""Up to so many boxes of a group are written out."""


def grouping_section(analysis: Analysis | None) -> Section:
    """Show from which behaviour the groups were found, how sure they are, and the levels."""
    title = "From behaviour to curriculum"
    if analysis is None:
        missing = Notice(
            title="Not there yet",
            sentences=("The run has not reached the analysis: there are no groups to show.",),
        )
        return Section(anchor="grouping", title=title, blocks=(missing,))
    blocks: list[Block] = [
        Paragraph(
            text=f"{counted(int(analysis.n_trials.sum()), 'trial')} on "
            f"{counted(analysis.variants.shape[0], 'variant')} by {analysis.networks} were logged. "
            "The behaviour on each variant was described by a mixture of Gaussians over "
            f"{listed([axis_label(name) for name in analysis.features.names])}; variants with "
            "similar mixtures form a group, and groups are ranked by their success."
        ),
        mixture_fit(analysis),
        distances_and_groups(analysis),
        group_table(analysis),
        level_table(analysis),
        Paragraph(text=stability_statement(analysis.stability)),
    ]
    sure = success_and_stability(analysis)
    if sure is not None:
        blocks.append(sure)
    boundaries = stability_table(analysis)
    if boundaries is not None:
        blocks.append(boundaries)
    if analysis.sensitivity:
        blocks.append(sensitivity_table(analysis))
    if analysis.warnings:
        blocks.append(
            Notice(title="What the analysis itself warns of", sentences=analysis.warnings)
        )
    return Section(anchor="grouping", title=title, blocks=tuple(blocks))


def group_table(analysis: Analysis) -> Table:
    """Return table 1: success in the logged trials per group."""
    rows: list[tuple[str, ...]] = []
    for index, group in enumerate(analysis.groups):
        own = analysis.labels == index
        tried = int(analysis.n_trials[own].sum())
        won = int(analysis.trials_won[own].sum())
        limits = proportion_intervals([won], [tried])
        rows.append(
            (
                group.name,
                variant_range(analysis.parameters, group.variants),
                str(len(group.variants)),
                percent(group.success_rate),
                f"{won} / {tried}",
                percent_interval(limits.lower[0], limits.upper[0]),
                number(group.complexity, 2),
            )
        )
    return Table(
        label="Table 1",
        title="Success in the logged trials of each group",
        columns=(
            Column(heading="group"),
            Column(heading="variants"),
            Column(heading="number", numeric=True),
            Column(heading="success", numeric=True),
            Column(heading="trials won", numeric=True),
            Column(heading="95 % interval", numeric=True),
            Column(heading="complexity", numeric=True),
        ),
        rows=tuple(rows),
        notes=(
            (
                "Success is the mean over the group's variants; complexity is 1 minus it. Wilson "
                "intervals over trials."
            ),
        ),
    )


def level_table(analysis: Analysis) -> Table | Paragraph:
    """Return table 2: weights and bounds of each level."""
    curriculum = analysis.curriculum
    if not curriculum.levels:
        return Paragraph(
            text="The curriculum has no levels: every group already reaches a success of "
            f"{percent(curriculum.success_threshold)} in the logged trials."
        )
    bounds = [_bounds(curriculum.parameters, group) for group in curriculum.groups]
    return Table(
        label="Table 2",
        title="Levels of the curriculum: weight of each group",
        columns=(
            Column(heading="group"),
            Column(heading="drawn uniformly from"),
            *(
                Column(heading=f"level {index + 1}", numeric=True)
                for index in range(curriculum.n_levels)
            ),
        ),
        rows=tuple(
            (
                group.name,
                bounds[index],
                *(
                    f"{number(level.weights[index], 2)}"
                    + (" ★" if level.dominant == group.name else "")
                    for level in curriculum.levels
                ),
            )
            for index, group in enumerate(curriculum.groups)
        ),
        notes=(
            (
                "Each level draws tasks from the mixture of eq. 4 with these weights; ★ marks its "
                "dominant group. The paper's own weights are lost; these are assumed."
            ),
        ),
    )


def _bounds(parameters: Sequence[str], group: Group) -> str:
    """Return where a group's tasks are drawn from: boxes, or their number and what they span."""
    if len(group.boxes) <= MOST_BOXES:
        return " and ".join(_span(parameters, box.lower, box.upper) for box in group.boxes)
    lower = np.min([box.lower for box in group.boxes], axis=0)
    upper = np.max([box.upper for box in group.boxes], axis=0)
    return f"{len(group.boxes)} cells within {_span(parameters, lower, upper)}"


def _span(parameters: Sequence[str], lower: FloatArray, upper: FloatArray) -> str:
    return ", ".join(
        f"{interval(float(low), float(high), 4)} {name_and_unit(name)[1]}".strip()
        for name, low, high in zip(parameters, lower, upper, strict=True)
    )


def stability_statement(stability: Stability | None) -> str:
    """Say how sure the grouping is."""
    if stability is None:
        return "How stable the grouping is was not assessed."
    counts = listed([f"{count} in {percent(share)}" for count, share in stability.group_counts])
    return (
        f"How sure is this grouping? Networks and trials were drawn again "
        f"{counted(stability.replicates, 'time')} and grouped by the same rule. The number of "
        f"groups was {counts} of these replicates; on average a replicate agreed with the grouping "
        f"above on {percent(stability.agreement)} of all pairs of variants."
    )


def stability_table(analysis: Analysis) -> Table | None:
    """Return how often each boundary between groups came back; ``None`` where there is none."""
    stability = analysis.stability
    if stability is None or analysis.variants.shape[1] != 1:
        return None
    unit = name_and_unit(analysis.parameters[0])[1]
    rows = [
        (
            f"{variant_label(analysis.variants[i])} | {variant_label(analysis.variants[i + 1])} "
            f"{unit}".strip(),
            (
                f"{analysis.groups[analysis.labels[i]].name} | "
                f"{analysis.groups[analysis.labels[i + 1]].name}"
            ),
            percent(float(stability.boundaries[i])),
        )
        for i in range(len(analysis.variants) - 1)
        if analysis.labels[i] != analysis.labels[i + 1]
    ]
    if not rows:
        return None
    return Table(
        label="",
        title="How often each boundary came back",
        columns=(
            Column(heading="between"),
            Column(heading="groups"),
            Column(heading="replicates", numeric=True),
        ),
        rows=tuple(rows),
    )


def sensitivity_table(analysis: Analysis) -> Fold:
    """Return which groups there would be with one choice of the analysis changed."""
    same = sum(row.agreement >= 1 for row in analysis.sensitivity)
    table = Table(
        label="",
        title="How much each choice matters",
        columns=(
            Column(heading="choice"),
            Column(heading="changed to"),
            Column(heading="groups", numeric=True),
            Column(heading="agreement", numeric=True),
        ),
        rows=tuple(
            (row.choice, row.value, str(row.n_groups), f"{row.agreement:.2f}")
            for row in analysis.sensitivity
        ),
        notes=("Agreement 1 means the same groups (adjusted Rand index).",),
    )
    return Fold(
        summary=f"With one choice changed, {same} of {len(analysis.sensitivity)} times the groups "
        "are the same",
        blocks=(table,),
    )
