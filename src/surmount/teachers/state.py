"""Saved progress names the teacher and the tasks that it belongs to."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from surmount.core.errors import InputError


def belongs_to(teacher: str, tasks: Any) -> dict[str, Any]:
    """Return what a saved state says of its owner.

    Parameters
    ----------
    teacher
        Name of the teacher.
    tasks
        What it chooses among, as JSON values.
    """
    return {"teacher": teacher, "chooses_among": tasks}


def require_same(state: Mapping[str, Any], teacher: str, tasks: Any) -> None:
    """Refuse the state of another teacher, or of the same one with other tasks.

    Raises
    ------
    InputError
        Naming both teachers, or saying that the tasks differ.
    """
    other = state.get("teacher", "none that says so")
    if other != teacher:
        raise InputError(
            f"The saved progress belongs to another teacher: {other}, not {teacher}.",
            remedy="Resume with the teacher it was saved under, or start afresh.",
        )
    if state["chooses_among"] != tasks:
        raise InputError(
            "The saved progress belongs to another curriculum or other tasks.",
            remedy="Resume with the curriculum or the tasks it was saved under, or start afresh.",
        )
