"""The registered tasks are listed with what one must know to choose among them."""

from __future__ import annotations

import subprocess
import sys

from surmount.cli.main import run


def test_every_task_of_rstar_is_listed_with_its_parameter_and_range(capsys):
    assert run(["tasks"]) == 0
    out = capsys.readouterr().out
    assert "rstar/step: RSTAR and the step" in out
    assert "height_mm: 21 to 50 mm;" in out
    assert "width_mm: 180 to 320 mm;" in out
    assert "  30 variants" in out


def test_one_task_is_shown_with_its_variants_and_settings(capsys):
    assert run(["tasks", "low-entrance"]) == 0
    out = capsys.readouterr().out
    assert "55, 60, 65" in out
    assert 'env.robot.gear = "wheels"' in out


def test_somebodys_environment_has_no_settings(capsys):
    assert run(["tasks", "own_point:make_env"]) == 0
    assert "no settings of its own" in capsys.readouterr().out


def test_no_verb_loads_a_learner_or_a_simulator_to_tell_its_options():
    program = """
import sys
from surmount.cli.main import VERBS, run
for verb in VERBS:
    try:
        run([verb, "--help"])
    except SystemExit as ended:
        assert not ended.code, verb
heavy = {"torch", "mujoco", "scipy.stats", "matplotlib", "plotly", "polars"} & set(sys.modules)
sys.exit(", ".join(heavy) or None)
"""
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_flag_counts_over_set_and_set_over_a_file(capsys, tmp_path):
    file = tmp_path / "c.toml"
    file.write_text('seed = 1\nnetworks = 7\n"env.robot.gear" = "whegs"\n', encoding="utf-8")
    call = ["config", "step", "--config", str(file), "--set", "networks=3", "--seed", "9"]
    assert run([*call, "--env.robot.gear", "both"]) == 0
    out = capsys.readouterr().out
    assert "seed = 9\nnetworks = 3\n" in out
    assert 'env.robot.gear = "both"' in out


def test_set_needs_no_quotes_inside_quotes(capsys):
    assert run(["config", "step", "--set", "env.robot.gear=both"]) == 0
    assert 'env.robot.gear = "both"' in capsys.readouterr().out


def test_a_mistyped_verb_names_the_nearest(capsys):
    assert run(["shwo"]) == 2
    assert "Did you mean `show`?" in capsys.readouterr().err
