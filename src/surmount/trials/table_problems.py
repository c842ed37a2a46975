"""Problems of a table of trials, gathered before anything is refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from surmount.core.arrays import IntArray
from surmount.core.errors import InputError

_SHOWN_ROWS = 5
_SHOWN_PROBLEMS = 20


def _counted_from_one(row: int) -> str:
    return str(row + 1)


@dataclass
class Problems:
    """Problems found so far, each with its remedy.

    Attributes
    ----------
    place
        How a row, counted from 0, is called.
    found
        Problems and their remedies.
    """

    place: Callable[[int], str] = _counted_from_one
    found: list[tuple[str, str]] = field(default_factory=list[tuple[str, str]])

    def add(self, problem: str, remedy: str) -> None:
        """Note a problem."""
        self.found.append((problem, remedy))

    def rows(self, rows: IntArray, problem: str, remedy: str) -> None:
        """Note a problem of some rows, counted from 0, if there are any."""
        if rows.size:
            listed = ", ".join(self.place(int(row)) for row in rows[:_SHOWN_ROWS])
            more = f" and {rows.size - _SHOWN_ROWS} more" if rows.size > _SHOWN_ROWS else ""
            self.add(f"row{'s' if rows.size > 1 else ''} {listed}{more}: {problem}", remedy)

    def raise_if_any(self, source: str) -> None:
        """Refuse the table with all problems at once."""
        if not self.found:
            return
        shown = [f"{problem}. {remedy}" for problem, remedy in self.found[:_SHOWN_PROBLEMS]]
        if len(self.found) > _SHOWN_PROBLEMS:
            shown.append(f"and {len(self.found) - _SHOWN_PROBLEMS} more problems.")
        if len(shown) == 1:
            raise InputError(f"{source}: {self.found[0][0]}.", remedy=self.found[0][1])
        listed = "".join(f"\n  {number}. {text}" for number, text in enumerate(shown, start=1))
        raise InputError(
            f"{source} has {len(self.found)} problems:{listed}\n",
            remedy="Correct them all and try again.",
        )
