"""A verb that works for long says its first word before it imports what takes seconds."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

HEAVY = ("torch", "mujoco", "altair", "matplotlib", "stable_baselines3")
PROGRAM = """
import io, json, sys
from surmount.cli.main import run
heavy, calls = json.loads(sys.argv[1])
found, told, written = {}, sys.stdout, io.StringIO()

class First(io.StringIO):
    def write(self, text):
        if text.strip():
            found[verb] = {"said": text, "loaded": [name for name in heavy if name in sys.modules]}
            sys.stdout = sys.stderr = written
            raise KeyboardInterrupt

for verb, *rest in calls:
    sys.stdout = sys.stderr = First()
    run([verb, *rest])
print(json.dumps(found), file=told)
"""


def _calls(folder) -> list[list[str]]:
    out = ["--out", str(folder / "out")]
    return [
        ["analyze", "example", *out],
        ["rollout", "step", "--policy", "nowhere:load", "--out", str(folder / "trials.csv")],
        ["reproduce", "step", *out],
        ["compare", "step", *out],
        ["report", str(folder)],
        ["evaluate", str(folder / "network.safetensors")],
        ["render", "step", "--variant", "50", "--out", str(folder / "film.gif")],
        ["capability", "step", *out],
        ["manoeuvres", "--out", str(folder / "found.json")],
        ["initiations", str(folder / "settings.toml"), *out],
        ["regimes", str(folder / "map.toml"), *out],
        ["teachers", str(folder / "plan.toml"), *out],
    ]


@pytest.fixture(scope="module")
def first_signs(tmp_path_factory):
    """Return what each verb said first, and what had been imported by then, from one process."""
    calls = _calls(tmp_path_factory.mktemp("first"))
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", PROGRAM, json.dumps([HEAVY, calls])],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert [*found] == [call[0] for call in calls]
    return found


def test_the_first_word_comes_before_what_takes_seconds_to_import(first_signs):
    late = {verb: sign["loaded"] for verb, sign in first_signs.items() if sign["loaded"]}
    assert late == {}


def test_the_first_word_tells_what_is_being_done(first_signs):
    for verb, sign in first_signs.items():
        assert not sign["said"].startswith("surmount:"), (verb, sign["said"])
