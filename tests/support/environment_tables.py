"""Markdown tables of what an environment shows and takes, from the code that does it.

``docs/environments.md`` holds them; a test compares.
"""

from __future__ import annotations

from collections.abc import Iterable

from surmount.rstar.course.actions import ACTION_TERMS
from surmount.rstar.course.infos import INFO_KEYS
from surmount.rstar.course.observations import observation_terms
from surmount.rstar.course.obstacles import Obstacle


def observation_table(obstacle: Obstacle) -> str:
    """Return the entries of an obstacle's observation: index, symbol, unit, range, scaling."""
    rows = [
        (
            index,
            term.name,
            term.symbol,
            term.unit,
            (
                f"{term.centre - term.bound * term.scale:g} to "
                f"{term.centre + term.bound * term.scale:g}"
            ),
            f"{term.centre:g}",
            f"{term.scale:g}",
            f"± {term.bound:g}",
            term.meaning,
        )
        for index, term in enumerate(observation_terms(obstacle))
    ]
    head = ("index", "entry", "symbol", "unit", "range", "centre", "scale", "observed", "meaning")
    return _table(head, rows)


def action_table() -> str:
    """Return the entries of an action: index, symbol, unit, range, rate of a full action."""
    rows = [
        (
            index,
            term.name,
            term.symbol,
            term.unit,
            _range(term.lower, term.upper),
            f"{term.rate:g} {term.unit} per s",
            "−1 to 1",
            term.meaning,
        )
        for index, term in enumerate(ACTION_TERMS)
    ]
    head = (
        "index",
        "target",
        "symbol",
        "unit",
        "range of the target",
        "full action",
        "action",
        "meaning",
    )
    return _table(head, rows)


def info_table() -> str:
    """Return what ``info`` holds after every reset and step."""
    return _table(("key", "meaning"), ((f"`{key}`", text) for key, text in INFO_KEYS.items()))


def _range(low: float, high: float) -> str:
    return f"{low:g} to {high:g}".replace("-", "−")


def _table(head: tuple[str, ...], rows: Iterable[tuple[object, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)
