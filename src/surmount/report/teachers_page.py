"""The page of a comparison of teachers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from surmount.report.document.parts import (
    Block,
    Column,
    Document,
    Notice,
    Paragraph,
    Section,
    Table,
)
from surmount.report.document.text import (
    counted,
    integer,
    listed,
    percent,
    percent_interval,
    reached,
    signed,
)
from surmount.report.figures.teachers import sampled_figure, score_figure
from surmount.report.teacher_changes import changes_section
from surmount.report.writing import write_document
from surmount.tasks.curriculum import ONE_GROUP

NAME = "teachers"
FEW_NETWORKS = 5
"""Networks below which the page says that nothing can be concluded."""

Record = Mapping[str, Any]


def write_teachers_report(record: Record, root: Path) -> Path:
    """Write the page of a comparison and its figures.

    Parameters
    ----------
    record
        ``teachers.json`` of the comparison.
    root
        The run's folder.
    """
    return write_document(document_of_teachers(record), root, NAME)


def document_of_teachers(record: Record) -> Document:
    """Lay out the page."""
    teachers = record["teachers"]
    networks = len(teachers[0]["success"])
    best = max(teachers, key=lambda teacher: teacher["interquartile_mean"]["estimate"])
    highest = percent(best["interquartile_mean"]["estimate"])
    summary = [
        _sure(teachers),
        f"Highest interquartile mean of success: {best['title']}, {highest}.",
    ]
    steps = sum(sum(teacher["steps"]) for teacher in teachers)
    notices: list[Notice] = []
    if networks < FEW_NETWORKS:
        few = (
            f"{counted(networks, 'network')} cannot tell teachers apart: this shows that the "
            "comparison runs, and says nothing about who is better."
        )
        notices.append(Notice(title="Too few networks", sentences=(few,)))
    if len(record["groups"]) == 1 and steps:
        summary = summary[:1]
        notices.append(Notice(title="One group", sentences=(ONE_GROUP,)))
    if steps == 0:
        summary = ["There was nothing to teach, so nothing can be said of any teacher."]
        nobody = (
            "The paper's curriculum has no levels: it took no learning steps, and no other teacher "
            "got any. All scores are those of the networks after the initiation."
        )
        notices.append(Notice(title="Nothing to compare", sentences=(nobody,)))
    blocks: tuple[Block, ...] = (
        Paragraph(
            text="Every teacher trained the same initial networks on, each for as many steps as "
            "the paper's curriculum took with it, and was tested on every variant alike. Scores "
            "are success rates in these tests; intervals are 95 % bootstrap intervals over "
            "networks (one task family is one stratum), which are too narrow with fewer than ten."
        ),
        score_figure(record),
        _score_table(record),
        _duel_table(record),
        _speed_table(record),
    )
    changes = changes_section(teachers)
    return Document(
        title="Teachers compared",
        subtitle="The paper's curriculum beside other ways of choosing tasks, at equal budgets",
        notices=tuple(notices),
        summary=tuple(summary),
        facts=(
            ("teachers", str(len(teachers))),
            ("networks each", str(networks)),
            ("steps", f"{integer(steps)} in all"),
        ),
        sections=(
            Section(anchor="scores", title="Success", blocks=blocks),
            Section(anchor="sampled", title="What each sampled", blocks=(sampled_figure(record),)),
            *(() if changes is None else (changes,)),
            Section(anchor="settings", title="Settings", blocks=(_settings_table(record),)),
        ),
    )


def _sure(teachers: Sequence[Record]) -> str:
    """Say which differences the paired interval over networks tells from zero."""
    titles = {teacher["name"]: teacher["title"] for teacher in teachers}
    found = [
        f"{teacher['title']} against {titles[other]} ({signed(100 * mean['estimate'])} points)"
        for teacher in teachers
        for other, duel in teacher["against"].items()
        for mean in (duel["mean_difference"],)
        if mean["lower"] is not None and (mean["lower"] > 0 or mean["upper"] < 0)
    ]
    if not found:
        return (
            "Over networks no difference from the paper's curriculum or from uniform tasks is "
            "sure: every paired interval includes zero."
        )
    return f"Paired intervals over networks that exclude zero: {listed(found)}."


def _table(title: str, header: Sequence[str], rows: Sequence[Sequence[str]], *notes: str) -> Table:
    return Table(
        label="",
        title=title,
        columns=tuple(Column(heading=name, numeric=index > 0) for index, name in enumerate(header)),
        rows=tuple(tuple(row) for row in rows),
        notes=notes,
    )


def _score_table(record: Record) -> Table:
    rows = [
        (
            f"{teacher['title']} ({teacher['source']})",
            percent(teacher["interquartile_mean"]["estimate"]),
            _limits(teacher["interquartile_mean"]),
            *(percent(group["estimate"]) for group in teacher["mean_by_group"]),
        )
        for teacher in record["teachers"]
    ]
    groups = [f"mean, {name}" for name in record["groups"]]
    return _table("Success over networks", ("teacher", "IQM", "interval", *groups), rows)


def _limits(interval: Record) -> str:
    return percent_interval(interval["lower"], interval["upper"])


def _duel_table(record: Record) -> Table:
    rows = [
        (
            f"{teacher['title']} against {other}",
            signed(100 * duel["mean_difference"]["estimate"]),
            _limits(duel["mean_difference"]).replace("%", "points"),
            percent(duel["probability_of_improvement"]["estimate"]),
            _limits(duel["probability_of_improvement"]),
        )
        for teacher in record["teachers"]
        for other, duel in teacher["against"].items()
    ]
    return _table(
        "Each against the paper's curriculum and against uniform tasks",
        (
            "",
            "difference of means (points)",
            "interval (t)",
            "probability of improvement",
            "interval",
        ),
        rows,
        "The difference is judged by a paired t-test's interval, which holds with few networks.",
    )


def _speed_table(record: Record) -> Table:
    rows = [
        (
            teacher["title"],
            *(
                reached(speed["n_reached"], speed["n_networks"], speed["median_steps"])
                for speed in teacher["steps_to_95"]
            ),
        )
        for teacher in record["teachers"]
    ]  # fmt: skip
    return _table(
        "Learning steps until 95 % of a group's training episodes succeed",
        ("teacher", *record["groups"]),
        rows,
        f"Of the group's newest {record['window_episodes']} episodes in training, with random "
        "starts and exploration, on the tasks that the teacher chose within the group: a teacher "
        "that hardly samples a group is hardly measured on it. Networks that get there, and the "
        "median over all by Kaplan and Meier.",
    )


def _settings_table(record: Record) -> Table:
    rows = [
        (
            teacher["title"],
            ", ".join(f"{name} = {value}" for name, value in teacher["settings"].items())
            or "none of its own",
        )
        for teacher in record["teachers"]
    ]
    return Table(
        label="",
        title="Settings of each teacher",
        columns=(Column(heading="teacher"), Column(heading="settings")),
        rows=tuple(rows),
        notes=("Learner, levels and test to advance are those of the run: see its own page.",),
    )
