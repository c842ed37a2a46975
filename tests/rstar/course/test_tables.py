"""The page on the environments says what the code does."""

import re
from pathlib import Path

import numpy as np
import pytest
from environment_tables import (
    action_table,
    info_table,
    observation_table,
    stuck_table,
    target_table,
)

from surmount.rstar.course.actions import ACTION_TERMS
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import OBSTACLES

PAGE = (Path(__file__).parents[3] / "docs" / "environments.md").read_text(encoding="utf-8")


def test_the_page_holds_the_tables_as_the_code_makes_them():
    tables = [observation_table(obstacle) for obstacle in OBSTACLES.values()]
    for table in (*tables, target_table(), action_table(), info_table(), stuck_table()):
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


@pytest.mark.parametrize("name", OBSTACLES)
def test_targets_are_observed_before_the_size_and_leave_the_other_entries_as_they_were(name):
    rows = [line.split("|")[1:-1] for line in target_table().splitlines()[2:]]
    plain = ObstacleVectorEnv(name, 2, n_threads=1)
    env = ObstacleVectorEnv(name, 2, config=EnvConfig(observe_targets=True), n_threads=1)
    count = plain.single_observation_space.shape[0]
    assert env.single_observation_space.shape == (count + 3,)
    assert env.single_observation_space.high[count - 1 : -1].tolist() == [1.0, 1.0, 1.0]
    new = np.arange(count - 1, count + 2)
    for envs in (plain, env):
        envs.reset(seed=0, options={"start": "fixed"})
    for _ in range(10):  # 0.1 s
        action = [[1.0, -1.0, 0.5], [0.0, 0.0, 0.0]]
        (seen, _, _, _, _), (told, _, _, _, _) = plain.step(action), env.step(action)
    np.testing.assert_array_equal(np.delete(told, new, axis=1), seen)
    centre, scale = (np.array([float(row[i]) for row in rows]) for i in (4, 5))
    values = told[:, new] * scale + centre
    assert values == pytest.approx(np.array([[0.1, -8.0, 52.0], [0.0, 0.0, 48.0]]), abs=1e-5)


def test_the_table_of_the_stuck_robot_is_the_formula_of_the_page():
    # 1 + 1e-4 · 2,000 · D_z/unit, with the front axle a wheel's radius before the face.
    left_m = 0.32 + (145.6 / 2 + 30.58) * 1e-3
    swung_m = left_m - 50.09e-3 * np.sin(np.radians(72.0))
    rows = [line.split("|")[2:-1] for line in stuck_table().splitlines()[2:]]
    found = np.array(rows, dtype=float)
    costs = [[1 + 0.2 * point_m / unit for point_m in (left_m, swung_m)] for unit in (1, 0.1, 0.01)]
    assert found[:, :2] == pytest.approx(np.array(costs), abs=0.0005)
    assert found[:, 2] == pytest.approx(-np.diff(costs)[:, 0], abs=0.0005)


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
