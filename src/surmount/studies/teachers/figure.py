"""The figure of a comparison: paired differences to uniform tasks, task by task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from surmount.report.document.parts import Figure
from surmount.report.figures.charts import figure
from surmount.report.figures.teachers import differences_panel

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
    return Figure(
        name="teachers-differences",
        label="",
        title="Paired differences to uniform tasks",
        caption=("Mean over networks with its bootstrap interval; networks are paired.",),
        alternative="Points with intervals, one per teacher, a panel per task.",
        chart=figure(
            [
                differences_panel(name, [row[1:] for row in rows if row[0] == name], (), AXIS)
                for name in names
            ],
            columns=1,
            least_px=420,
            pick=False,
        ),
        data={
            "task": [task for task, _, _ in rows],
            "teacher": [teacher for _, teacher, _ in rows],
            **{end: [100 * mean[end] for _, _, mean in rows]
               for end in ("estimate", "lower", "upper")},
        },
    )  # fmt: skip
