"""Curricula as tables and as Python files for other frameworks."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from importlib import resources
from pprint import pformat
from string import Template

from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError
from surmount.core.names import text_cell
from surmount.exports.export import Export, require_levels
from surmount.exports.ml_agents import export_ml_agents
from surmount.tasks.curriculum import Curriculum

_EQ5 = (
    "The file holds levels and the defaults of eq. 5's test; change the lengths at its top to "
    "those of your training."
)


def export_table(curriculum: Curriculum) -> Export:
    """Return one row per level and box, with the probability and the bounds."""
    require_levels(curriculum)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = curriculum.parameters
    bounds = [f"{name}_{side}" for side in ("lower", "upper") for name in names]
    writer.writerow(["level", "dominant", "group", "weight", *map(text_cell, bounds)])
    for number, level in enumerate(curriculum.levels, 1):
        for group, weight in zip(curriculum.groups, level.weights, strict=True):
            total = sum(box.weight for box in group.boxes)
            for box in group.boxes:
                if weight * box.weight > 0:
                    share = weight * box.weight / total
                    writer.writerow(
                        [number, text_cell(level.dominant), text_cell(group.name), share,
                         *box.lower.tolist(), *box.upper.tolist()]
                    )  # fmt: skip
    return Export(
        files={"curriculum.csv": text.getvalue()},
        notes=("A table holds levels, weights and bounds, not when to go on to the next level.",),
    )


def export_sb3(curriculum: Curriculum) -> Export:
    """Return a Python file with a wrapper and a callback that need no Surmount."""
    return Export(
        files={"curriculum_sb3.py": _filled("sb3_curriculum.txt", curriculum)},
        notes=(
            "curriculum_sb3.py needs Stable-Baselines3, Gymnasium and NumPy, not Surmount.",
            _EQ5,
        ),
    )


def export_syllabus(curriculum: Curriculum) -> Export:
    """Return a Python file that makes a Syllabus curriculum."""
    return Export(
        files={"curriculum_syllabus.py": _filled("syllabus_curriculum.txt", curriculum)},
        notes=(
            "curriculum_syllabus.py needs Syllabus, not Surmount.",
            "Its tasks are indices of boxes: draw each parameter uniformly within the bounds.",
            "Syllabus tells of episodes, not of steps: the lengths of eq. 5 are in episodes there.",
        ),
    )


FORMATS: dict[str, Callable[[Curriculum], Export]] = {
    "ml-agents": export_ml_agents,
    "syllabus": export_syllabus,
    "sb3": export_sb3,
    "csv": export_table,
}
"""By the name that the command line takes."""


def export_curriculum(curriculum: Curriculum, to: str) -> Export:
    """Return a curriculum in a format.

    Raises
    ------
    ConfigError
        If there is no such format.
    InputError
        If the curriculum has no levels, or the format cannot hold it.
    """
    if to not in FORMATS:
        raise ConfigError(f"Unknown format `{to}`.", remedy=nearest(to, [*FORMATS]))
    return FORMATS[to](curriculum)


def _filled(template: str, curriculum: Curriculum) -> str:
    require_levels(curriculum)
    levels = [
        dict(curriculum.level_distribution(level).to_record())
        for level in range(curriculum.n_levels)
    ]
    boxes = pformat(
        [
            {
                "dominant": curriculum.levels[index].dominant,
                "weights": level["weights"],
                "lower": level["lower"],
                "upper": level["upper"],
            }
            for index, level in enumerate(levels)
        ],
        width=100,
        sort_dicts=False,
    )
    text = resources.files("surmount.exports").joinpath(template).read_text(encoding="utf-8")
    return Template(text).substitute(parameters=list(curriculum.parameters), levels=boxes)
