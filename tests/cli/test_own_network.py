"""A network on somebody's own environment is tried, exported and drawn from its file alone."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import onnx
import pytest
from PIL import Image
from stable_trainings import OFF, config_of, trainer

from surmount.cli.main import run
from surmount.learn.snapshot import TRAINED_ON
from surmount.workflow.monitor import SilentMonitor

SUPPORT = Path(__file__).parents[1] / "support"
WITHOUT_MUJOCO = """
import sys
sys.modules["mujoco"] = None
sys.path.insert(0, sys.argv[1])
from surmount.experiment.presets import preset
from surmount.experiment.protocol import protocol
config = preset("any_spaces:discrete", "smoke")
print(len(protocol(config)), config.family.training_env(config.env, 2).num_envs)
"""


@pytest.fixture(scope="module")
def network(tmp_path_factory):
    """Of DQN, as a run writes it."""
    made = trainer(config_of("DQN", OFF), ("discrete", "box"), steps=64).run(SilentMonitor())
    told = {TRAINED_ON: {"task": "any_spaces:discrete", "env": {}}}
    path = tmp_path_factory.mktemp("own") / "network.safetensors"
    replace(made.network, record={**made.network.record, **told}).save(path)
    return path


def test_it_is_tried(network, capsys):
    assert run(["evaluate", str(network), "--repetitions", "2"]) == 0
    assert "goal_m" in capsys.readouterr().out


def test_it_is_exported(network, tmp_path):
    assert run(["export", str(network), "--to", "onnx", "--out", str(tmp_path)]) == 0
    model = onnx.load(str(tmp_path / "policy.onnx"))
    told = {entry.key: json.loads(entry.value) for entry in model.metadata_props}
    assert told["algorithm"]["algorithm"] == "DQN"


def test_it_is_drawn_by_the_environments_own_render(network, tmp_path, capsys):
    film = tmp_path / "film.gif"
    assert run(["render", str(network), "--variant", "0.5", "2.0", "--out", str(film)]) == 0
    out = capsys.readouterr().out
    assert "goal_m 0.5: " in out
    assert "goal_m 2" in out
    with Image.open(film) as drawn:
        assert drawn.size == (64, 32)
        assert drawn.n_frames > 1


@pytest.mark.parametrize(("more", "said"), [
    (["--variant", "far"], "far"),
    (["--set", "learner.num_envs=3"], "`learner.num_envs` would do nothing here"),
])  # fmt: skip
def test_what_cannot_be_drawn_or_would_do_nothing_is_refused(network, more, said, tmp_path, capsys):
    assert run(["render", str(network), *more, "--out", str(tmp_path / "film.gif")]) in (2, 3)
    assert said in capsys.readouterr().err


def test_an_environment_of_ones_own_needs_no_mujoco():
    found = subprocess.run(  # noqa: S603 - our own interpreter
        [sys.executable, "-c", WITHOUT_MUJOCO, str(SUPPORT)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    stages, envs = map(int, found.stdout.split())
    assert stages > 10
    assert envs == 2
