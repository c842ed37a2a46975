"""What a teacher changed and why: a record and a sentence for every change of its main group.

Level tests tell why the paper's levels end (:class:`~surmount.teachers.teacher.LevelTest`).
Teachers that choose otherwise keep a log of changes: which group was practised most before and
after, and which was mastered, fell, or was skipped. It is saved with the teacher and with the
training.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal, Protocol, get_args, runtime_checkable

ChangeKind = Literal["main group", "mastered", "fell", "plateau", "skipped", "left", "back", "stop"]
"""What changed, see :attr:`Change.kind`."""


@dataclass(frozen=True, kw_only=True)
class Change:
    """One change.

    Attributes
    ----------
    steps
        Learning steps since the teacher began.
    kind
        ``"main group"``: another group is practised most. ``"mastered"`` and ``"fell"``: a group
        counts as mastered, or no more. ``"plateau"``: a group's success stands still.
        ``"skipped"``, ``"left"``, ``"back"``: a level was passed over, left, or gone back to.
        ``"stop"``: everything is mastered.
    group
        The group that it is about: of ``"main group"`` the new one.
    before
        The group practised most before; ``None`` where there was none or it stays.
    sentence
        The same for people, with the numbers that decided.
    """

    steps: int
    kind: ChangeKind
    group: str
    before: str | None
    sentence: str

    def to_record(self) -> dict[str, Any]:
        """Return the JSON form."""
        return asdict(self)


@runtime_checkable
class Explaining(Protocol):
    """A teacher that tells what it changed."""

    @property
    def changes(self) -> Sequence[Change]:
        """All changes so far, in order."""
        ...


def changes_of(teacher: object) -> tuple[Change, ...]:
    """Return the changes of a teacher; none of one that keeps no log of them."""
    return tuple(teacher.changes) if isinstance(teacher, Explaining) else ()


def change_from_record(record: Mapping[str, Any]) -> Change:
    """Build from the JSON form; an unknown kind is a :class:`ValueError`."""
    if record["kind"] not in get_args(ChangeKind):
        raise ValueError(f"There is no change of kind {record['kind']!r}.")
    return Change(**record)


def describe_changes(title: str, records: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the changes of one training as lines, under a title."""
    return [title, *(f"  {record['sentence']}" for record in records)]


class ChangeLog:
    """The changes of one teacher, in order."""

    def __init__(self) -> None:
        self._changes: list[Change] = []

    @property
    def all(self) -> tuple[Change, ...]:
        """All changes so far."""
        return tuple(self._changes)

    def add(
        self, steps: int, kind: ChangeKind, group: str, sentence: str, *, before: str | None = None
    ) -> None:
        """Add a change; the sentence is put after the steps."""
        self._changes.append(
            Change(
                steps=steps,
                kind=kind,
                group=group,
                before=before,
                sentence=f"{steps:,} steps: {sentence}",
            )
        )

    def state(self) -> list[dict[str, Any]]:
        """Return what is saved."""
        return [change.to_record() for change in self._changes]

    def load(self, state: Sequence[Mapping[str, Any]]) -> None:
        """Take up what :meth:`state` returned."""
        self._changes = [change_from_record(record) for record in state]
