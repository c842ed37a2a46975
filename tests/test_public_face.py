"""What is public is found at once, is typed, and loads nothing that it does not need."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

import surmount

ROOT = Path(__file__).parents[1]
HEAVY = ("torch", "mujoco", "scipy.stats", "gymnasium", "polars", "matplotlib", "altair", "rich")


def test_importing_surmount_loads_none_of_the_heavy_packages():
    program = f"import surmount, sys; print([m for m in {HEAVY} if m in sys.modules])"
    told = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert told.stdout.strip() == "[]"


@pytest.mark.parametrize("name", surmount.__all__)
def test_every_public_name_is_there(name):
    assert getattr(surmount, name) is not None


def test_the_version_is_that_of_the_distribution():
    assert surmount.__version__ == version("surmount")


def test_documents_import_from_surmount_alone():
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    inner = [
        f"{page.name}: {line}"
        for page in pages
        for line in page.read_text(encoding="utf-8").splitlines()
        if re.match(r"\s*(from|import) surmount\.", line) and "import surmount.rstar" not in line
    ]
    assert inner == []


def test_a_strict_project_of_a_user_type_checks(tmp_path):
    (tmp_path / "theirs.py").write_text(
        """
import numpy as np

import surmount


def teach(trials: surmount.Trials) -> surmount.LevelTeacher:
    analysis = surmount.determine_curriculum(trials)
    curriculum = analysis.curriculum
    levels = [curriculum.level_distribution(level) for level in range(curriculum.n_levels)]
    return surmount.LevelTeacher(levels, surmount.AdvancementConfig())


def draw(teacher: surmount.LevelTeacher) -> float:
    return float(np.asarray(teacher.sample(1))[0, 0])


space = surmount.TaskSpace.grid(slope_deg=range(0, 31, 5))
experiment = surmount.Experiment.begin("rstar/step", "runs/step", preset="smoke")
version: str = surmount.__version__
wrong: int = surmount.__version__
""",
        encoding="utf-8",
    )
    (tmp_path / "pyrightconfig.json").write_text(
        json.dumps(
            {
                "typeCheckingMode": "strict",
                "include": ["."],
                "extraPaths": [(ROOT / "src").as_posix()],
                "reportMissingTypeStubs": False,
            }
        ),
        encoding="utf-8",
    )
    checker = Path(sys.executable).with_name("basedpyright")
    told = subprocess.run(  # noqa: S603
        [checker, "--project", tmp_path, "--pythonpath", sys.executable],
        capture_output=True,
        text=True,
        check=False,
    )
    errors = [line for line in told.stdout.splitlines() if " error: " in line]
    assert len(errors) == 1, told.stdout
    assert 'Type "str" is not assignable to declared type "int"' in errors[0]
