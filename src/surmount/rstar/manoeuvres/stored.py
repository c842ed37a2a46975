"""Manoeuvres that come with the package: one for each of the 63 variants.

They were found and chosen by ``surmount manoeuvres`` for the default physics (ADR 20).
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from surmount.core.errors import InputError
from surmount.rstar.course.obstacles import find_obstacle
from surmount.rstar.manoeuvres.manoeuvre import Manoeuvre

FILE = "manoeuvres.json"
"""Beside this module."""


@dataclass(frozen=True, kw_only=True)
class StoredManoeuvre:
    """A manoeuvre and what it was found to do.

    Attributes
    ----------
    size_mm
        The variant that it overcomes.
    time_s
        Time it takes from the fixed start pose to the target line, in s.
    bears
        Names of the conditions under which it succeeds; see
        :data:`surmount.rstar.manoeuvres.library.CONDITIONS`.
    manoeuvre
        The manoeuvre.
    """

    size_mm: float
    time_s: float
    bears: tuple[str, ...]
    manoeuvre: Manoeuvre


@cache
def stored_manoeuvres(obstacle: str) -> tuple[StoredManoeuvre, ...]:
    """Return the manoeuvres of an obstacle, by size.

    Raises
    ------
    ConfigError
        If there is no such obstacle.
    """
    find_obstacle(obstacle)
    text = files("surmount.rstar.manoeuvres").joinpath(FILE).read_text(encoding="utf-8")
    return tuple(
        StoredManoeuvre(
            size_mm=entry["size_mm"],
            time_s=entry["time_s"],
            bears=tuple(entry["bears"]),
            manoeuvre=Manoeuvre.from_record(entry["phases"]),
        )
        for entry in json.loads(text)["obstacles"][obstacle]
    )


def stored_manoeuvre(obstacle: str, size_mm: float) -> StoredManoeuvre:
    """Return the manoeuvre for a variant, or that of the nearest harder one.

    Raises
    ------
    ConfigError
        If there is no such obstacle.
    InputError
        If the size is harder than every variant.
    """
    stored = stored_manoeuvres(obstacle)
    if find_obstacle(obstacle).harder > 0:
        fitting = [found for found in stored if found.size_mm >= size_mm][:1]
    else:
        fitting = [found for found in stored if found.size_mm <= size_mm][-1:]
    if not fitting:
        raise InputError(
            f"No stored manoeuvre overcomes {obstacle} {size_mm:g} mm.",
            remedy=f"Give a size from {stored[0].size_mm:g} to {stored[-1].size_mm:g} mm.",
        )
    return fitting[0]
