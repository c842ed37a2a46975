"""The summary printed at the end of a run, read from its artefacts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from surmount.analysis.description import describe_side
from surmount.core.records import read_record
from surmount.tasks.curriculum import ONE_GROUP, Curriculum
from surmount.workflow.run_folder import open_run
from surmount.workflow.run_layout import (
    ANALYSIS,
    CONTROL,
    CURRICULUM,
    CURRICULUM_FILE,
    INITIATION,
    STATISTICS,
    STATISTICS_FILE,
)


def print_summary(console: Console, root: Path) -> None:
    """Print groups, levels and the comparison of both arms."""
    stages = open_run(root).stages
    curriculum = Curriculum.load(stages[ANALYSIS].path(CURRICULUM_FILE))
    statistics = read_record(stages[STATISTICS].path(STATISTICS_FILE))
    table = Table(title="Success by group", title_justify="left")
    for column in ("group", "variants", INITIATION, CURRICULUM, CONTROL, "test of equality"):
        table.add_column(column)
    rows = zip(
        curriculum.groups,
        statistics["initiation_by_group"],
        statistics["groups_compared"],
        strict=True,
    )
    for group, initial, compared in rows:
        span = ", ".join(
            describe_side(axis, values)
            if axis.categorical
            else f"{axis.text(values.min())} to {axis.text(values.max())}"
            for axis, values in zip(curriculum.axes, group.variants.T, strict=True)
        )
        span += f" ({len(group.variants)})"
        table.add_row(
            escape(group.name),
            span,
            _share(initial),
            _share(compared["arms"][CURRICULUM]),
            _share(compared["arms"][CONTROL]),
            _verdict(compared["proportion_test"]),
        )
    if len(curriculum.groups) == 1 and curriculum.levels:
        console.print(f"One group. {ONE_GROUP}", soft_wrap=True, markup=False)
    console.print(table)
    for number, level in enumerate(curriculum.levels, start=1):
        weights = ", ".join(
            f"{group.name} {weight:.2f}"
            for group, weight in zip(curriculum.groups, level.weights, strict=True)
        )
        line = f"level {number}, for {level.dominant}: {weights}"
        console.print(line, soft_wrap=True, markup=False)
    if not curriculum.levels:
        console.print("no levels: every group already reaches the success that needs none")


def _share(count: dict[str, Any]) -> str:
    successes, trials = count["successes"], count["trials"]
    return f"{successes}/{trials} ({100 * successes / trials:.0f} %)"


def _verdict(test: dict[str, Any]) -> str:
    if test["p_value"] is None:
        return "undefined: all trials ended alike"
    return f"χ² = {test['statistic']:.2f}, p = {test['p_value']:.2g}"
