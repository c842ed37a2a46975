"""Records of runs that were made before names changed, in today's terms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_NAMES = {"obstacle": "task", "scale": "preset", "own_sha256": "fingerprint"}

RENAMED = {
    "decision_interval_s": "step_s",
    "physics_tick_s": "physics_step_s",
    "action_delay_decisions": "action_delay_steps",
}
"""Fields of a task's settings: names of before, and of today."""

_BEFORE = {today: before for before, today in RENAMED.items()}


def up_to_date(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return the record of a configuration, or a part of one, by today's names.

    Until version 0.1 a family of tasks was called an obstacle, a preset a scale, and the only
    fingerprint was that of one's own file.
    """
    found = {_NAMES.get(key, key): value for key, value in record.items()}
    if ":" in str(found.get("task", "")) and "obstacle" in record:
        found.pop("env", None)  # RSTAR's settings stood unused beside one's own environment
    if isinstance(found.get("env"), Mapping):
        found["env"] = renamed(found["env"])
    return found


def renamed(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return the record of a task's settings, or of what was taken from them, by today's names."""
    return _renamed(record, RENAMED)


def as_before(part: Mapping[str, Any]) -> dict[str, Any]:
    """Return the part of a configuration that a stage depends on by the names of before.

    Only for registered tasks: RSTAR's settings stood beside somebody's own environment, so that the
    keys of its stages cannot be told any more.
    """
    found = dict(part)
    if "task" in found:
        found["obstacle"] = str(found.pop("task")).rpartition("/")[2]
        found["model_sha256"] = found.pop("fingerprint")
    if isinstance(found.get("env"), Mapping):
        found["env"] = _renamed(found["env"], _BEFORE)
    return found


def _renamed(record: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    return {
        names.get(key, key): _renamed(value, names) if isinstance(value, Mapping) else value
        for key, value in record.items()
    }
