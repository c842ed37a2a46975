"""Every verb's --help is there, and comes without what only working needs."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from surmount.cli.main import CONFIGURED, VERBS

HEAVY = ("torch", "mujoco", "scipy.stats", "scipy.cluster", "matplotlib", "altair", "polars")
PROGRAM = """
import contextlib, io, json, sys
from surmount.cli.main import run
heavy, calls = json.loads(sys.argv[1])
found = {}
for call in calls:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        try:
            code = run(call)
        except SystemExit as ended:
            code = ended.code
    loaded = [name for name in heavy if name in sys.modules]
    found[" ".join(call)] = {"code": code, "loaded": loaded, "said": out.getvalue()}
print(json.dumps(found))
"""
CALLS = [
    ["--help"],
    ["--version"],
    *([verb, "--help"] for verb in VERBS),
    *([verb, "step", "--help"] for verb in CONFIGURED),
    ["tasks"],
    ["tasks", "step"],
    ["config", "step"],
]


@pytest.fixture(scope="module")
def answers():
    """Return what one process that has made all these calls said and had loaded after each."""
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", PROGRAM, json.dumps([HEAVY, CALLS])],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize("call", [" ".join(call) for call in CALLS])
def test_it_answers_without_what_only_working_needs(answers, call):
    answer = answers[call]
    assert answer["code"] == 0
    assert answer["loaded"] == []
    assert answer["said"]


@pytest.mark.parametrize("verb", VERBS)
def test_help_names_the_verb(answers, verb):
    assert f"surmount {verb}" in answers[f"{verb} --help"]["said"]


@pytest.mark.parametrize("verb", CONFIGURED)
def test_help_of_a_task_names_the_flags_of_its_settings(answers, verb):
    assert "--env.robot.gear {wheels,whegs,both}" in answers[f"{verb} step --help"]["said"]
    assert "--env.robot.gear" not in answers[f"{verb} --help"]["said"]
