"""The figure of a comparison: paired differences to uniform tasks, task by task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.report.document.parts import Figure
from surmount.report.figures.charts import figure
from surmount.report.figures.teachers import differences_panel
from surmount.studies.teachers.plan import REFERENCE

AXIS = "mean success, difference to uniform tasks (points)"
Record = Mapping[str, Any]


def differences_figure(tasks: Sequence[Record]) -> Figure | None:
    """Return the figure; ``None`` where nothing can be compared yet.

    Parameters
    ----------
    tasks
        Of the record of a comparison.
    """
    rows = [
        (task["title"], teacher["title"], found["mean"])
        for task in tasks
        for teacher in task["teachers"]
        if (found := teacher["against"]) is not None and found["mean"]["lower"] is not None
    ]
    if not rows:
        return None
    names = list(dict.fromkeys(task for task, _, _ in rows))
    points = {task["title"]: network_differences(task) for task in tasks}
    pairs = [(name, *point) for name in names for point in points[name]]
    return Figure(
        name="teachers-differences",
        label="",
        title="Paired differences to uniform tasks",
        caption=(
            (
                "Rings: every network's difference to the one of uniform tasks that began alike. "
                "Dots and lines: their mean with its bootstrap interval."
            ),
        ),
        alternative="Rings for networks and a dot with an interval, one row per teacher, a panel "
        "per task.",
        chart=figure(
            [
                differences_panel(
                    name, [row[1:] for row in rows if row[0] == name], points[name], AXIS
                )
                for name in names
            ],
            columns=1,
            least_px=420,
            pick=False,
        ),
        data={
            "task": [*(row[0] for row in rows), *(pair[0] for pair in pairs)],
            "teacher": [*(row[1] for row in rows), *(pair[1] for pair in pairs)],
            "network": [*[None] * len(rows), *(pair[2] for pair in pairs)],
            "estimate": [
                *(100 * mean["estimate"] for _, _, mean in rows),
                *(100 * pair[3] for pair in pairs),
            ],
            **{
                end: [*(100 * mean[end] for _, _, mean in rows), *[None] * len(pairs)]
                for end in ("lower", "upper")
            },
        },
    )


def network_differences(task: Record) -> list[tuple[str, int, float]]:
    """Return what each network of a drawn teacher gained over uniform tasks, in mean success.

    Parameters
    ----------
    task
        Of the record of a comparison.

    Returns
    -------
    list of (str, int, float)
        Title of the teacher, network and difference as a share, for every pair.
    """
    teachers: Sequence[Record] = task["teachers"]
    reference = next(
        (teacher["success"] for teacher in teachers if teacher["name"] == REFERENCE), {}
    )
    return [
        (
            teacher["title"],
            network,
            float(np.mean(teacher["success"][str(network)]) - np.mean(reference[str(network)])),
        )
        for teacher in teachers
        if (found := teacher["against"]) is not None and found["mean"]["lower"] is not None
        for network in teacher["judged"]
    ]
