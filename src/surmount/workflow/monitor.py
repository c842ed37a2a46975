"""How long work tells of its progress and is asked to stop."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol


class Interrupted(Exception):  # noqa: N818 - not an error: the work was saved and can go on
    """Raised by work that was asked to stop and has saved what it needs to go on."""


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far a piece of work has come.

    Attributes
    ----------
    label
        What is being done, for example ``"level 1 of 3"``.
    done
        Units done.
    planned
        Units planned in all as far as known; ``None`` where the end cannot be foreseen.
    unit
        For example ``"steps"``.
    values
        Figures worth showing, for example the success rate.
    """

    label: str
    done: int
    planned: int | None
    unit: str = "steps"
    values: Mapping[str, float] = field(default_factory=dict[str, float])


class Monitor(Protocol):
    """Receives progress and sentences for the log, and says when to stop."""

    def progress(self, progress: Progress) -> None:
        """Show how far the work has come."""
        ...

    def log(self, sentence: str) -> None:
        """Record a sentence for people."""
        ...

    def should_stop(self) -> bool:
        """Whether the work should save itself and raise :class:`Interrupted`."""
        ...


class SilentMonitor:
    """A monitor that shows nothing and never stops the work."""

    def progress(self, progress: Progress) -> None:
        """Show nothing."""

    def log(self, sentence: str) -> None:
        """Record nothing."""

    def should_stop(self) -> bool:
        """Go on."""
        return False
