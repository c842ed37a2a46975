"""What an export consists of, and what it needs of a curriculum."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from surmount.core.errors import InputError
from surmount.tasks.curriculum import Curriculum


@dataclass(frozen=True, kw_only=True)
class Export:
    """Files, and what they cannot say.

    Attributes
    ----------
    files
        Text by file name.
    notes
        Sentences on how to use them, and on what the format cannot express.
    """

    files: Mapping[str, str]
    notes: tuple[str, ...]


def require_levels(curriculum: Curriculum) -> None:
    """Refuse a curriculum that has no level to take away.

    Raises
    ------
    InputError
        If there is none.
    """
    if not curriculum.levels:
        raise InputError(
            "The curriculum has no levels, so there is nothing to export.",
            remedy="Only groups that succeed in less than "
            f"{100 * curriculum.success_threshold:g} % of their trials get one: record harder "
            "variants, or analyse with a higher `success_threshold`.",
        )
