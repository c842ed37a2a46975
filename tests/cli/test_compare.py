"""``surmount compare`` takes runs as they are and ignores no option; no levels, no contest."""

from __future__ import annotations

import json

import pytest
from small import SMALL

from surmount.cli.main import run

OWN = {key: value for key, value in SMALL.items() if not key.startswith("env.")} | {"networks": 1}


def options(root, **changes):
    values = [
        word
        for key, value in (OWN | changes).items()
        for word in ("--set", f"{key}={json.dumps(value)}")
    ]
    return ["own_point:make_env", "--out", str(root), "--processes", "0", *values]


@pytest.fixture(scope="module")
def reproduced(tmp_path_factory):
    root = tmp_path_factory.mktemp("own") / "run"
    assert run(["reproduce", *options(root)]) == 0
    return root


def test_a_finished_run_is_taken_with_its_own_configuration(reproduced, capsys):
    command = ["compare", "--resume", "--out", str(reproduced), "--processes", "0"]
    chosen = [*command, "--teachers", "plr", "--set", "teaching.plr.temperature=0.5"]
    assert run(chosen) == 0
    assert "prioritised level replay" in capsys.readouterr().out
    text = (reproduced / "teachers.md").read_text(encoding="utf-8")
    assert "temperature = 0.5, staleness = 0.1" in text
    logged = (reproduced / "logs" / "run.log").read_text(encoding="utf-8")
    assert logged.count("initiation/network-0: finished") == 1
    own_page = (reproduced / "report.md").read_text(encoding="utf-8")
    assert "| test-control/network-0 |" in own_page
    assert "teach/plr" not in own_page  # nor in its sum of computing


def test_a_run_with_another_configuration_is_refused_with_a_way_out(reproduced, capsys):
    assert run(["compare", "own_point:make_env", "--networks", "3", "--out", str(reproduced)]) != 0
    error = capsys.readouterr().err
    assert "was made by another configuration" in error
    assert "--resume" in error


def test_without_a_level_there_is_a_page_that_says_so(tmp_path, capsys):
    nothing = options(tmp_path / "run", **{"analysis.success_threshold": 0.0})
    assert run(["compare", *nothing, "--teachers", "easy-to-hard", "plr"]) == 0
    text = (tmp_path / "run" / "teachers.md").read_text(encoding="utf-8")
    assert "The paper's curriculum has no levels" in text
    assert "Highest" not in text
    assert "0 in all" in text


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        ("teaching.alp_gmm.fit_episodes=50", "setting of alp-gmm, which is not among the teachers"),
        ("teaching.plr.temprature=0.3", "`teaching.plr.temperature`"),
        ("teaching.plr.temperature=0", "`temperature` is 0"),
    ],
)
def test_a_setting_that_would_have_no_effect_is_refused(setting, expected, tmp_path, capsys):
    out = tmp_path / "run"
    assert run(["compare", "step", "--out", str(out), "--teachers", "plr", "--set", setting]) == 2
    assert expected in " ".join(capsys.readouterr().err.split())
    assert not out.exists()
