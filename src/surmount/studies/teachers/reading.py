"""How the outcomes of a comparison are read: the rules of the plan, written before the runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from surmount.report.document.text import listed
from surmount.studies.teachers.judging import LEVEL, MARGIN, has_headroom

Verdict = Literal["helps", "harms", "no harm", "not sure", "not run"]
"""Of one teacher on one task, see :func:`verdict`."""
Record = Mapping[str, Any]


def verdict(teacher: Record) -> Verdict:
    """Judge a teacher on one task against uniform tasks.

    On a held-out task with headroom it *helps* or *harms* where Holm's p value is below the level
    and the mean difference above or below zero. Everywhere else it *harms* where the whole interval
    of the mean difference lies below minus the margin, and does *no harm* where it lies above. What
    remains is *not sure*.
    """
    found = teacher["against"]
    if found is None or found["mean"]["lower"] is None:
        return "not run"
    mean = found["mean"]
    if "holm_p" in found and found["holm_p"] < LEVEL:
        return "helps" if mean["estimate"] > 0 else "harms"
    if mean["upper"] < -MARGIN:
        return "harms"
    return "no harm" if mean["lower"] > -MARGIN else "not sure"


def winners(tasks: Sequence[Record]) -> list[str]:
    """Return the names of teachers that help on one held-out task and harm on none.

    On every task that was run, tuning tasks left out, each must help, do no harm, or be not sure
    with an estimate above minus the margin.
    """
    judged = [task for task in tasks if task["role"] == "held out"]
    names = dict.fromkeys(
        teacher["name"] for task in judged for teacher in task["teachers"] if teacher["against"]
    )
    return [name for name in names if _wins(judged, name)]


def _wins(tasks: Sequence[Record], name: str) -> bool:
    helps = False
    for task in tasks:
        for teacher in task["teachers"]:
            if teacher["name"] != name:
                continue
            found = verdict(teacher)
            helps |= found == "helps"
            if found == "harms":
                return False
            if found == "not sure" and teacher["against"]["mean"]["estimate"] <= -MARGIN:
                return False
    return helps


def answer(tasks: Sequence[Record]) -> list[str]:
    """Return the answer: who wins, where there was nothing to win, and what is not sure."""
    titles = {teacher["name"]: teacher["title"] for task in tasks for teacher in task["teachers"]}
    won = winners(tasks)
    judged = [task for task in tasks if task["role"] == "held out"]
    compared = any(teacher["against"] for task in judged for teacher in task["teachers"])
    if won:
        first = (
            f"Over uniform tasks {listed([titles[name] for name in won])} "
            f"{'helps' if len(won) == 1 else 'help'} on at least one held-out task and "
            f"{'harms' if len(won) == 1 else 'harm'} on none."
        )
    elif not compared:
        first = "No teacher has been run beside uniform tasks yet: this is the headroom alone."
    else:
        first = "No teacher is shown to help over uniform tasks on a held-out task without harm."
    flat = [task["title"] for task in judged if task["headroom"] and not has_headroom(task)]
    second = (
        f"Even half of the tasks from the hard ones gain nothing sure on {listed(flat)}: there no "
        "teacher has much to win."
        if flat
        else "On every held-out task that was run, more of the hard tasks would gain."
    )
    unrun = [task["title"] for task in judged if not task["headroom"]]
    if unrun:
        second = f"{second} Not run: {listed(unrun)}."
    open_ = [
        (found["smallest_detectable"], task["title"])
        for task in judged
        for teacher in task["teachers"]
        if (found := teacher["against"]) and verdict(teacher) == "not sure"
        and found["smallest_detectable"] is not None
    ]  # fmt: skip
    if not compared:
        return [first, second]
    if open_:
        largest, where = max(open_)
        third = (
            f"{len(open_)} comparisons are not sure; the least of them could have found "
            f"{100 * largest:.0f} points ({where})."
        )
    else:
        third = "No comparison is left unsure."
    return [first, second, third]
