"""Exports of curricula over axes of every kind draw as Surmount does."""

import csv
import io
import json
import types

import numpy as np
import pytest

from surmount.core.axis import Axis
from surmount.exports.formats import export_curriculum
from surmount.tasks.cells import cells
from surmount.tasks.curriculum import Box, Curriculum, Group, Level
from surmount.tasks.space import TaskSpace


def curriculum_over(space: TaskSpace) -> Curriculum:
    """Two groups of every second variant."""
    lower, upper = cells(space.variants, space.axes)
    return Curriculum(
        parameters=space.parameters,
        groups=tuple(
            Group(
                name=name,
                variants=space.variants[first::2],
                success_rate=rate,
                boxes=tuple(
                    Box(lower=lower[i], upper=upper[i], weight=1.0)
                    for i in range(first, len(space.variants), 2)
                ),
            )
            for first, name, rate in [(0, "easy", 0.9), (1, "difficult", 0.1)]
        ),
        levels=(Level(dominant="difficult", weights=(0.25, 0.75)),),
        success_threshold=0.95,
        axes=space.axes,
    )


MIXED = curriculum_over(
    TaskSpace.grid(
        friction=np.logspace(-2, 0, 3),
        n=[1, 4],
        terrain=["flat", "mud"],
        axes={"friction": "logarithmic"},
    )
)
TERRAIN = curriculum_over(TaskSpace.grid(terrain=["flat", "mud", "ice"]))
FRICTION = curriculum_over(
    TaskSpace.grid(friction=np.logspace(-2, 0, 3), axes={"friction": "logarithmic"})
)
COUNT = curriculum_over(TaskSpace.grid(n=[1, 2, 3, 4]))


def drawing_of(text: str) -> types.SimpleNamespace:
    """Return what a written file draws by, without the packages that the rest of it needs."""
    begin, end = text.index("PARAMETERS ="), text.index("class Level")
    space: dict = {"math": __import__("math"), "list": list}
    exec(text[begin:end], space)  # noqa: S102 - our own template
    return types.SimpleNamespace(**space)


@pytest.mark.parametrize(
    ("to", "file"), [("sb3", "curriculum_sb3.py"), ("syllabus", "curriculum_syllabus.py")]
)
def test_python_files_draw_the_same_tasks(to, file):
    drawing = drawing_of(export_curriculum(MIXED, to).files[file])
    level = MIXED.level_distribution(0)
    places = np.random.default_rng(0).random((50, 3))
    for index, place in enumerate(places):
        box = index % level.weights.size
        low, high = level.lower[box], level.upper[box]
        ours = [
            axis.value(float(axis.at(p, a, b)))
            for axis, p, a, b in zip(MIXED.axes, place, low, high, strict=True)
        ]
        task = drawing.task_between(low.tolist(), high.tolist(), place.tolist())
        assert task == dict(zip(MIXED.parameters, [pytest.approx(ours[0]), *ours[1:]], strict=True))
        assert isinstance(task["n"], int)


def test_a_table_holds_names_and_kinds():
    made = export_curriculum(MIXED, "csv")
    rows = list(csv.DictReader(io.StringIO(made.files["curriculum.csv"])))
    assert {row["terrain_lower"] for row in rows} == {"flat", "mud"}
    assert all(row["terrain_lower"] == row["terrain_upper"] for row in rows)
    assert {row["n_lower"] for row in rows} == {"1", "2", "3"} or {
        row["n_lower"] for row in rows
    } == {"1", "3"}
    assert [rows[0][f"{name}_kind"] for name in MIXED.parameters] == [
        "logarithmic",
        "integer",
        "categorical",
    ]
    assert any("Draw `friction` evenly in its logarithm" in note for note in made.notes)


def intervals(text: str) -> list[list[float]]:
    (line,) = (line for line in text.splitlines() if "intervals:" in line)
    return json.loads(line.split(":", 1)[1])


def test_ml_agents_gets_what_it_can_draw_evenly():
    made = export_curriculum(TERRAIN, "ml-agents")
    drawn = intervals(made.files["level_1.yaml"])
    assert all(high - low == 1 for low, high in drawn)
    assert {int(low) for low, _ in drawn} == {0, 1, 2}
    assert any("0 flat, 1 mud, 2 ice" in note and "clamp it to 2" in note for note in made.notes)
    made = export_curriculum(COUNT, "ml-agents")
    assert {tuple(one) for one in intervals(made.files["level_1.yaml"])} == {
        (n, n + 1.0) for n in (1, 2, 3, 4)
    }
    made = export_curriculum(FRICTION, "ml-agents")
    assert '"log10_friction":' in made.files["level_1.yaml"]
    assert min(low for low, _ in intervals(made.files["level_1.yaml"])) == pytest.approx(-2.0)
    made = export_curriculum(MIXED, "ml-agents")
    rows = list(csv.DictReader(io.StringIO(made.files["variant_index.csv"])))
    assert {row["terrain_lower"] for row in rows} == {"flat", "mud"}
    assert any("Draw `n` as a whole number" in note for note in made.notes)


def test_continuous_curricula_have_no_word_of_kinds():
    plain = curriculum_over(TaskSpace.grid(a=[0.0, 1.0, 2.0]))
    assert plain.axes == (Axis(),)
    assert (
        export_curriculum(plain, "csv")
        .files["curriculum.csv"]
        .splitlines()[0]
        .endswith("a_lower,a_upper")
    )
    assert len(export_curriculum(plain, "csv").notes) == 1
