"""The page on the environments says what the code does."""

import re
from pathlib import Path

import numpy as np
import pytest
from environment_tables import action_table, info_table, observation_table

from surmount.rstar.course.actions import ACTION_TERMS
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.obstacles import OBSTACLES

PAGE = (Path(__file__).parents[2] / "docs" / "environments.md").read_text(encoding="utf-8")


def test_the_page_holds_the_tables_as_the_code_makes_them():
    tables = [observation_table(obstacle) for obstacle in OBSTACLES.values()]
    for table in (*tables, action_table(), info_table()):
        assert table in PAGE, f"docs/environments.md should hold\n\n{table}"


@pytest.mark.parametrize("block", re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL))
def test_python_blocks_run(block):
    exec(compile(block, "environments.md", "exec"), {})  # noqa: S102


@pytest.mark.parametrize("obstacle", OBSTACLES.values(), ids=list(OBSTACLES))
def test_the_observations_of_the_table_are_those_that_the_environment_shows(obstacle):
    rows = [line.split("|")[1:-1] for line in observation_table(obstacle).splitlines()[2:]]
    env = ObstacleVectorEnv(obstacle.name, 1)
    seen, _ = env.reset(seed=0, options={"start": "fixed", "variant": obstacle.lower})
    assert env.single_observation_space.shape == (len(rows),)
    assert env.single_observation_space.high.tolist() == [float(row[7].strip(" ±")) for row in rows]
    centre, scale = (np.array([float(row[i]) for row in rows]) for i in (5, 6))
    values = dict(zip((row[1].strip() for row in rows), seen[0] * scale + centre, strict=True))
    start = {"yaw": 0, "fbem": 0, "sprawl": 48, "speed": 0, "distance": 0.26438}
    expected = {**start, "size": obstacle.lower}
    if obstacle.name == "step":
        expected["pitch"] = 0
    assert values == pytest.approx(expected, abs=1e-5)


def test_the_actions_of_the_table_are_the_servos_limits():
    env = ObstacleVectorEnv("step", 1)
    model, radius = env.simulation.model, 0.03058
    for term, servo, unit in zip(
        ACTION_TERMS,
        ("left_front", "left_fbem", "right_sprawl"),
        (radius, 180 / np.pi, 180 / np.pi),
        strict=True,
    ):
        actuator = model.actuator(servo)
        assert actuator.actrange * unit == pytest.approx([term.lower, term.upper])
        assert actuator.ctrlrange * unit == pytest.approx([-term.rate, term.rate])
