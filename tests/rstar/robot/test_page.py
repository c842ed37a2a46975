"""The page on the robot says what the constants say."""

import re
from pathlib import Path

import numpy as np
import pytest

from surmount.rstar.robot import constants as c
from surmount.rstar.robot import kinematics
from surmount.rstar.robot.config import RobotConfig
from surmount.rstar.robot.constants import QUANTITIES

PAGE = (Path(__file__).parents[3] / "docs" / "robot.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.splitlines()
    if line.startswith("|")
]


def test_every_quantity_stands_in_the_table_with_value_unit_and_source():
    sources = {"simulation": "SIMULATION", "paper": "PAPER", "derived": "DERIVED"}
    listed = {row[0].strip("`"): row for row in ROWS if row[0].startswith("`")}
    for name, quantity in QUANTITIES.items():
        _, meaning, value, unit, source = listed[name]
        assert float(value) == quantity.value
        assert unit == quantity.unit
        assert sources.get(source, "ASSUMED") == quantity.source.name
        assert meaning == quantity.meaning.rstrip(".")


def test_extents_stand_in_the_table_as_the_closed_forms_give_them():
    low, high = re.search(r"\| width \| 115–290 \| ([\d.]+) .*?– ([\d.]+) ", PAGE).groups()
    assert float(low) == pytest.approx(float(kinematics.width_mm(0.0, 0.0)), abs=0.05)
    widest = kinematics.width_mm(np.linspace(0, 180, 1801), 0.0).max()
    assert float(high) == pytest.approx(widest, abs=0.05)
    low, high = re.search(r"\| height \| 42–125 \| ([\d.]+) .*?– ([\d.]+) ", PAGE).groups()
    assert float(low) == pytest.approx(float(kinematics.height_mm(90.0, 0.0)), abs=0.05)
    assert float(high) == pytest.approx(float(kinematics.height_mm(0.0, 0.0)), abs=0.05)
    assert re.search(r"\| length \| 150 \| 150 ", PAGE)
    assert c.BAR_LENGTH_MM == 150


def test_defaults_that_the_page_names_are_the_configurations():
    config = RobotConfig()
    named = re.search(
        r"(\w+) at a friction of\s+([\d.]+), and physics steps of ([\d.]+) ms", PAGE
    ).groups()
    assert named == (config.gear, f"{config.friction:g}", f"{config.physics_step_s * 1e3:g}")
