"""Environments that other people wrote go through the whole method, each with its own learner."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from graphics import needs_graphics

from surmount.analysis.result import Analysis
from surmount.cli.main import run
from surmount.core.records import read_record
from surmount.experiment.experiment import Experiment
from surmount.workflow.run_folder import open_run
from surmount.workflow.run_layout import expected_stages

OTHERS = Path(__file__).parent.parent / "examples" / "others"
NEEDS = {
    "pole_lengths": (),
    "swing_masses": (),
    "stumps": ("Box2D",),
    "rebuilt_pole": ("mujoco", "sb3_contrib"),
    "crossings": ("minigrid",),
    "maze_goals": ("gymnasium_robotics",),
    "lake_maps": ("sb3_contrib",),
    "lander_choices": ("Box2D",),
    "moving_balls": ("minigrid",),
    "hidden_speeds": ("sb3_contrib",),
}
"""What each environment needs besides Surmount."""
DRAWN_BY_MUJOCO = ("rebuilt_pole", "maze_goals")
DRAWS = not needs_graphics.args[0]

pytestmark = pytest.mark.filterwarnings("default")  # what others' packages warn of is theirs


@pytest.fixture(params=NEEDS)
def name(request, monkeypatch):
    """Of an example, as if called in its folder."""
    for package in NEEDS[request.param]:
        pytest.importorskip(package, reason=f"{request.param} needs {package}")
    monkeypatch.chdir(OTHERS)
    monkeypatch.syspath_prepend(str(OTHERS))
    return request.param


def test_every_example_is_tried_and_has_its_learner():
    assert sorted(NEEDS) == sorted(path.stem for path in OTHERS.glob("*.py"))
    assert sorted(NEEDS) == sorted(path.stem for path in OTHERS.glob("*.toml"))


def test_cart_and_pole_go_through_everything(tmp_path, monkeypatch, capsys):
    """As small as it can be; the others below at the scale of their files."""
    monkeypatch.chdir(OTHERS)
    monkeypatch.setattr(sys, "path", [str(OTHERS), *sys.path])
    small = {
        "networks": 1,
        "initial_steps": 512,
        "trials.repetitions": 4,
        "tests.repetitions": 1,
        "learner.rollout_steps": 64,
        "analysis.bootstrap": 5,
        "analysis.components": 2,
        "advancement.iteration_steps": 512,
        "advancement.extension_steps": 256,
        "advancement.window_steps": 128,
    }
    changes = [word for key, value in small.items() for word in ("--set", f"{key}={value}")]
    reproduce("pole_lengths", tmp_path, *changes)
    assert_whole("pole_lengths", tmp_path, capsys.readouterr().out)


@pytest.mark.slow
def test_the_contract_is_kept(name, capsys):
    assert run(["check", f"{name}:make_env"]) == 0
    assert "BROKEN" not in capsys.readouterr().out


@pytest.mark.slow
def test_the_whole_method_runs(name, tmp_path, capsys):
    reproduce(name, tmp_path)
    assert_whole(name, tmp_path, capsys.readouterr().out)
    network = str(next((tmp_path / "stages" / "curriculum" / "network-0").rglob("network.*")))
    assert run(["evaluate", network, "--repetitions", "1"]) == 0
    assert run(["export", network, "--to", "onnx", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "policy.onnx").is_file()
    if DRAWS or name not in DRAWN_BY_MUJOCO:
        assert run(["render", network, "--out", str(tmp_path / "film.gif")]) == 0
        assert (tmp_path / "film.gif").stat().st_size > 1000


def reproduce(name: str, out: Path, *more: str) -> None:
    """Call what the docstring of an example says, in this process."""
    command = ["reproduce", f"{name}:make_env", "--preset", "smoke", "--config", f"{name}.toml"]
    assert run([*command, *more, "--out", str(out), "--processes", "0"]) == 0


def assert_whole(name: str, out: Path, told: str) -> None:
    """Check what a user sees: every stage, both arms or one group, the page and its films."""
    experiment = Experiment.open(out)
    assert set(expected_stages(experiment.config.networks)) <= set(open_run(out).stages)
    analysis = Analysis.load(open_run(out).stages["analysis"].path("analysis.json"))
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "test of" in told
    one = len(analysis.groups) == 1
    assert ("One group" in page) == one
    assert len(analysis.curriculum.levels) >= 1
    for word in ("RSTAR", "obstacle", " mm"):
        assert word not in re.sub(r"<script.*?</script>|data:[^\"']*", "", page, flags=re.DOTALL)
    if DRAWS or name not in DRAWN_BY_MUJOCO:
        films = read_record(out / "films" / "films.json")["films"]
        assert [film["kind"] for film in films] == ["initiation", "curriculum", "control"]
        assert page.count("<video") == 3
        assert sum(path.stat().st_size for path in (out / "films").iterdir()) < 1_000_000
