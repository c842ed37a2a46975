"""What teachers changed and why, on the page that compares them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from surmount.report.document.parts import Block, Column, Paragraph, Section, Table
from surmount.report.document.text import counted, integer

Record = Mapping[str, Any]


def changes_section(teachers: Sequence[Record]) -> Section | None:
    """Return the section on every change of the teachers that tell of them; ``None`` without any.

    Parameters
    ----------
    teachers
        Of ``teachers.json``.
    """
    telling = [teacher for teacher in teachers if any(teacher.get("changes", ()))]
    if not telling:
        return None
    # Stopped early or not, every teacher had the budget of the longest training of a network.
    budgets = [max(own) for own in zip(*(one["steps"] for one in teachers), strict=True)]
    blocks: list[Block] = [
        Paragraph(
            text="These teachers log every change of the group that they practise most. First, how "
            "often groups were mastered and fell again; then every change of the first network in "
            "the teacher's own words. Those of all networks are in the stages' training.json."
        ),
        _mastery_table(telling, budgets),
        *(_words_of(teacher) for teacher in telling),
    ]
    return Section(anchor="changes", title="What was practised when, and why", blocks=tuple(blocks))


def _mastery_table(teachers: Sequence[Record], budgets: Sequence[int]) -> Table:
    rows = [
        (teacher["title"], group, *_counts(teacher["changes"], group), _saved(teacher, budgets))
        for teacher in teachers
        for group in _groups(teacher["changes"])
    ]
    return Table(
        label="",
        title="Mastered, fallen, left",
        columns=(
            Column(heading="teacher"),
            Column(heading="group"),
            Column(heading="main group", numeric=True),
            Column(heading="mastered or left", numeric=True),
            Column(heading="fell or gone back from", numeric=True),
            Column(heading="stood still", numeric=True),
            Column(heading="all mastered"),
        ),
        rows=tuple(rows),
        notes=(
            (
                "Numbers of changes over all networks. All mastered: in how many networks every "
                "group was, and the steps that stopping there saves in the middle one of them."
            ),
        ),
    )


def _groups(changes: Sequence[Sequence[Record]]) -> list[str]:
    return list(dict.fromkeys(change["group"] for network in changes for change in network))


def _counts(changes: Sequence[Sequence[Record]], group: str) -> tuple[str, ...]:
    def count(*kinds: str) -> str:
        return integer(
            sum(
                change["group"] == group and change["kind"] in kinds
                for network in changes
                for change in network
            )
        )

    return (
        count("main group"),
        count("mastered", "skipped", "left"),
        count("fell", "back"),
        count("plateau"),
    )


def _saved(teacher: Record, budgets: Sequence[int]) -> str:
    ends = [
        (budget, change["steps"])
        for network, budget in zip(teacher["changes"], budgets, strict=True)
        for change in network
        if change["kind"] == "stop"
    ]
    if not ends:
        return "never"
    saved = sorted(max(0, budget - steps) for budget, steps in ends)[len(ends) // 2]
    return f"{counted(len(ends), 'network')}, {integer(saved)} steps"


def _words_of(teacher: Record) -> Table:
    return Table(
        label="",
        title=f"{teacher['title']}, network 1",
        columns=(Column(heading="change"), Column(heading="in words")),
        rows=tuple((change["kind"], change["sentence"]) for change in teacher["changes"][0]),
        notes=(),
    )
