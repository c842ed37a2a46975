"""The page of a comparison: an answer, one figure, a table to choose by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from surmount.report.document.parts import Block, Column, Document, Paragraph, Section, Table
from surmount.report.document.text import SPACE, counted, listed, percent
from surmount.report.writing import write_document
from surmount.studies.teachers.figure import differences_figure
from surmount.studies.teachers.judging import LEVEL, MARGIN, has_headroom
from surmount.studies.teachers.reading import (
    answer,
    best_first,
    difference,
    points,
    readings,
    verdict,
)
from surmount.studies.teachers.returns import EPISODES

NAME = "comparison"
"""Of the page and its Markdown."""
Record = Mapping[str, Any]


def write_page(record: Record, root: Path) -> Path:
    """Write ``comparison.html``, ``comparison.md`` and the figure."""
    return write_document(document_of(record), root, NAME)


def document_of(record: Record) -> Document:
    """Lay out the page."""
    tasks: Sequence[Record] = record["tasks"]
    blocks: list[Block] = [
        Paragraph(
            text="Every teacher went on from the same initial networks, each for the same number "
            "of steps, of which those that need groups paid for the trials these come from. Scores "
            "are success in tests on every variant from the trials' start. Measures, tests and "
            "their reading were fixed before the runs (plan.md)."
        ),
        *([] if (figure := differences_figure(tasks)) is None else [figure]),
        *(_choice_table(task) for task in tasks if best_first(task)),
        *([] if (ablations := _ablation_table(tasks)) is None else [ablations]),
        *(Paragraph(text=said) for said in readings(tasks)),
    ]
    return Document(
        title="Which teacher helps where",
        subtitle="A comparison whose plan was written beforehand",
        notices=(),
        summary=tuple(answer(tasks)),
        facts=tuple(
            (task["title"], f"{_most(task)} of {task['planned']['networks']} networks")
            for task in tasks
        ),
        sections=(
            Section(anchor="differences", title="Against uniform tasks", blocks=tuple(blocks)),
            Section(
                anchor="scores",
                title="Success",
                blocks=(
                    *(_score_table(task) for task in tasks if _most(task)),
                    *(table for task in tasks if (table := _returns_table(task)) is not None),
                ),
            ),
        ),
    )


def _most(task: Record) -> int:
    return max((len(teacher["judged"]) for teacher in task["teachers"]), default=0)


def _choice_table(task: Record) -> Table:
    rows = [
        (
            teacher["title"],
            verdict(teacher).replace(" ", SPACE),
            difference(found["mean"]),
            points(found["worst"]),
            percent(found["probability_of_improvement"]["estimate"]),
            f"{found.get('holm_p', found['wilcoxon_p']):.3f}",
            _detectable(found),
            str(found["networks"]),
        )
        for teacher in best_first(task)
        if (found := teacher["against"])
    ]
    return Table(
        label="",
        title=f"Which to choose on tasks like {task['title']}",
        columns=(
            Column(heading="teacher"),
            Column(heading="verdict"),
            Column(heading="mean, points", numeric=True),
            Column(heading="worst quarter", numeric=True),
            Column(heading="better", numeric=True),
            Column(heading="p", numeric=True),
            Column(heading="detectable", numeric=True),
            Column(heading="pairs", numeric=True),
        ),
        rows=tuple(rows),
        notes=(
            (
                "Mean: paired difference of mean success to uniform tasks with its bootstrap "
                "interval over networks. Worst quarter: of the mean over each network's worst "
                "quarter of variants, points. Better: probability that a network beats one of "
                "uniform tasks on a variant. p: Wilcoxon's, by Holm over all comparisons on "
                f"held-out tasks with headroom; it must be below {100 * LEVEL:g} %, for these are "
                "looked at twice. Detectable: what a paired t-test finds in four of five cases, "
                f"points. No harm: the interval lies above −{100 * MARGIN:.0f} points."
            ),
        ),
    )


def _ablation_table(tasks: Sequence[Record]) -> Table | None:
    rows = [
        (
            task["title"],
            name,
            str(found["networks"]),
            difference(found["mean"]),
            f"{found.get('holm_p', found['wilcoxon_p']):.3f}",
            _detectable(found),
        )
        for task in tasks
        for name, found in task["ablations"].items()
        if found is not None
    ]
    if not rows:
        return None
    return Table(
        label="",
        title="What the frontier owes to its groups",
        columns=(
            Column(heading="task"),
            Column(heading="frontier against"),
            Column(heading="pairs", numeric=True),
            Column(heading="mean, points", numeric=True),
            Column(heading="p", numeric=True),
            Column(heading="detectable, points", numeric=True),
        ),
        rows=tuple(rows),
        notes=("As above; these comparisons are a family of their own for Holm.",),
    )


def _detectable(found: Record) -> str:
    smallest = found["smallest_detectable"]
    return "none" if smallest is None else f"{100 * smallest:.0f}"


def _score_table(task: Record) -> Table:
    rows = [
        (
            teacher["title"],
            str(summary["networks"]),
            percent(summary["mean"]["estimate"]),
            percent(summary["interquartile_mean"]["estimate"]),
            percent(summary["worst"]),
            str(teacher["below_initial"]),
        )
        for teacher in task["teachers"]
        if (summary := teacher["summary"]) is not None
    ]
    headroom = task["headroom"]
    said = "The oracle was not run."
    if headroom is not None:
        verb = "tells" if has_headroom(task) else "does not tell"
        said = (
            f"The oracle gains {difference(headroom['mean'])} points over uniform tasks in "
            f"{headroom['networks']} networks, which {verb} that there is something to win."
        )
    return Table(
        label="",
        title=f"{task['title']} ({task['role']})",
        columns=(
            Column(heading="teacher"),
            Column(heading="networks", numeric=True),
            Column(heading="mean", numeric=True),
            Column(heading="interquartile mean", numeric=True),
            Column(heading="worst quarter of variants", numeric=True),
            Column(heading="below their initial network", numeric=True),
        ),
        rows=tuple(rows),
        notes=(said, *_costs(task), *_taken_over(task)),
    )


def _taken_over(task: Record) -> list[str]:
    elsewhere = sum(len(teacher["elsewhere"]) for teacher in task["teachers"])
    if not elsewhere:
        return []
    networks = counted(elsewhere, "network")
    return [f"{networks} of all teachers together were taken over from a record, not trained here."]


def _costs(task: Record) -> list[str]:
    """Say what trials cost the teachers that need them."""
    steps = list(task["trial_steps"].values())
    payers = [one["title"] for one in task["teachers"] if one["pays_for_trials"] and one["judged"]]
    if not steps or not payers:
        return []
    budget = task["planned"]["budget_steps"]
    mean, least, most = (percent(one(steps) / budget) for one in (np.mean, min, max))
    cost = f"Of {budget:,} steps trials cost {mean} ({least} to {most})"
    return [f"{cost}, paid by {listed(payers)}."]


def _returns_table(task: Record) -> Table | None:
    rows = [
        (
            teacher["title"],
            str(len(found)),
            f"{np.mean(found):.2f}",
            f"{min(found):.2f} to {max(found):.2f}",
            "{:.1f} to {:.1f}".format(*published)
            if (published := teacher["published_returns"])
            else "",
        )
        for teacher in task["teachers"]
        if (found := list(teacher["returns"].values()))
    ]
    if not rows:
        return None
    return Table(
        label="",
        title=f"{task['title']}: discounted return",
        columns=(
            Column(heading="teacher"),
            Column(heading="networks", numeric=True),
            Column(heading="mean", numeric=True),
            Column(heading="over networks", numeric=True),
            Column(heading="published", numeric=True),
        ),
        rows=tuple(rows),
        notes=(
            (
                f"Of {EPISODES} episodes on tasks drawn from the target, by the policy as it draws "
                "its actions, discounted as it learnt. Published: where the authors' curve ends."
            ),
        ),
    )
