"""How the outcomes of a comparison are read: the rules of the plan, written before the runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from surmount.report.document.text import MINUS, counted, listed
from surmount.studies.teachers.judging import ABLATED, LEVEL, MARGIN, has_headroom

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
    won = winners(tasks)
    judged = [task for task in tasks if task["role"] == "held out"]
    compared = [
        (found["mean"]["estimate"], teacher, task)
        for task in judged
        for teacher in task["teachers"]
        if (found := teacher["against"])
    ]
    if won:
        first = (
            "Over uniform tasks these help, and harm on no task that was run: "
            f"{listed(_helped(judged, won))}."
        )
    elif not compared:
        first = "No teacher has been run beside uniform tasks yet: this is the headroom alone."
    else:
        _, best, task = max(compared, key=lambda one: one[0])
        first = (
            "No teacher is shown to help over uniform tasks on a held-out task without harm; "
            f"nearest is {best['title']} with {gain(best['against'])} on {task['title']}."
        )
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
    if not compared:
        return [first, second]
    open_ = [
        (teacher["against"]["smallest_detectable"], task["title"])
        for _, teacher, task in compared
        if verdict(teacher) == "not sure" and teacher["against"]["smallest_detectable"] is not None
    ]
    if open_:
        largest, where = max(open_)
        which = "it" if len(open_) == 1 else "the least of them"
        third = (
            f"{counted(len(open_), 'comparison')} {'is' if len(open_) == 1 else 'are'} not sure; "
            f"{which} could have found {100 * largest:.0f} points ({where})."
        )
    else:
        third = "No comparison is left unsure."
    return [first, second, third]


def readings(tasks: Sequence[Record]) -> list[str]:
    """Return what the plan says to each outcome, in its order and for each task in turn.

    Read are the held-out tasks that have headroom and teachers (plan.md, *How each outcome will be
    read*). On the others no claim of merit is made.
    """
    read = [
        task
        for task in tasks
        if task["role"] == "held out"
        and has_headroom(task)
        and any(teacher["against"] for teacher in task["teachers"])
    ]
    return [f"{task['title']}: {said}" for task in read for said in _readings_of(task, tasks)]


SHUFFLED = "rstar/shuffled"
"""The task whose parameters say nothing about what is alike."""
OURS = ("frontier", "mastery")
"""The teachers that practise groups by behaviour, without the paper's test of growth."""


def _readings_of(task: Record, tasks: Sequence[Record]) -> list[str]:
    teachers = {teacher["name"]: teacher for teacher in task["teachers"] if teacher["against"]}
    titles = {name: teacher["title"] for name, teacher in teachers.items()}
    helping = [name for name, teacher in teachers.items() if verdict(teacher) == "helps"]
    said = [
        f"{titles[name]} wins here; it is what we recommend on tasks of this kind."
        for name in OURS
        if name in helping and name in winners(tasks)
    ]
    others = [name for name in helping if name not in OURS and name in winners(tasks)]
    if others and not set(OURS) & set(helping):
        said.append(
            f"{listed([titles[name] for name in others])} {'is' if len(others) == 1 else 'are'} "
            "recommended; groups by behaviour are readable and not shown to be better than uniform "
            "tasks."
        )
    if ABLATED in helping:
        said += [
            _ablated(titles.get(name, name), meant, found)
            for name, meant in _MEANT.items()
            if (found := task["ablations"].get(name)) is not None
        ]
    elsewhere = [one for other in tasks if other is not task for one in other["teachers"]]
    if (
        task["name"] == SHUFFLED
        and ABLATED in helping
        and not any(one["name"] == ABLATED and verdict(one) == "helps" for one in elsewhere)
    ):
        said.append(
            "behaviour helps where the parameters mislead, and there alone, which is what was "
            "claimed of it."
        )
    if {"paper", "mastery"} <= teachers.keys() and ("paper" in helping) != ("mastery" in helping):
        said.append("the test that ends levels matters more than their order.")
    if not helping:
        least = max((one["against"]["smallest_detectable"] or 0.0) for one in teachers.values())
        said.append(
            "no teacher that was tried is shown to find what the oracle shows is there; "
            f"{100 * least:.0f} points would have been found in four of five cases."
        )
    return said


_MEANT = {
    "frontier-cells": "the gain is that of valuing what is half learnt; pooling by groups is an "
    "explanation and not a gain",
    "frontier-parameters": "any groups do; behaviour is not what helps on this task",
}
"""What it means that the frontier is not shown to be better than itself without an idea."""


def _ablated(title: str, meant: str, found: Record) -> str:
    sure = found.get("holm_p", found["wilcoxon_p"]) < LEVEL
    if sure and found["mean"]["estimate"] > 0:
        return f"the frontier is ahead of {title} by {gain(found)}: what that lacks is a gain."
    if sure:
        return f"the frontier is behind {title} by {gain(found)}: {meant}."
    return f"the frontier is not shown to be better than {title} ({gain(found)}): {meant}."


def _helped(tasks: Sequence[Record], names: Sequence[str]) -> list[str]:
    """Say for each task which of some teachers help there, and by how much, the most first."""
    said: list[str] = []
    for task in tasks:
        helping = [
            one for one in best_first(task) if one["name"] in names and verdict(one) == "helps"
        ]
        if helping:
            gains = [
                f"{one['title']} by {points(one['against']['mean']['estimate'])}" for one in helping
            ]
            pairs = helping[0]["against"]["networks"]
            said.append(f"on {task['title']} {listed(gains)} points ({pairs} networks)")
    return said


def best_first(task: Record) -> list[Record]:
    """Return the teachers that stand beside the reference on a task, by what they gain."""
    compared = [teacher for teacher in task["teachers"] if teacher["against"]]
    return sorted(compared, key=lambda teacher: -teacher["against"]["mean"]["estimate"])


def gain(found: Record) -> str:
    """Return a paired difference with its interval and the number of pairs, in points."""
    return f"{difference(found['mean'])} points ({found['networks']} networks)"


def difference(mean: Record) -> str:
    """Return a difference of shares with its interval, in points."""
    estimate = points(mean["estimate"])
    if mean["lower"] is None:
        return estimate
    return f"{estimate} ({points(mean['lower'])} to {points(mean['upper'])})"


def points(share: float) -> str:
    """Return a difference of shares in points with one decimal and its sign: ``"+9.4"``."""
    return f"{100 * share:+.1f}".replace("-", MINUS)
