"""What is printed is safe on any terminal, and any standard output is borne."""

from __future__ import annotations

import ast
import io
import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from example_trials import two_behaviours
from rich.table import Table

import surmount
from surmount.cli.main import run
from surmount.core.printing import LONGEST_MESSAGE, complain, escaped
from surmount.trials.table import write_trials
from surmount.workflow.console import SafeConsole

ACTING = "\x1b]0;owned\x07\x1b[2J\x9b31m\u202e\r\x7f"
COMMAND = [sys.executable, "-m", "surmount"]
BAD = "nonsense"


def call(*arguments: object, **options) -> subprocess.CompletedProcess[bytes]:
    done = subprocess.run(  # noqa: S603
        [*COMMAND, *map(str, arguments)], check=False, stderr=subprocess.PIPE, **options
    )
    assert b"Traceback" not in done.stderr, done.stderr
    assert b"Exception ignored" not in done.stderr, done.stderr
    return done


def test_every_character_that_acts_on_a_terminal_is_shown_instead():
    text = escaped(ACTING)
    assert text.isprintable()
    assert text.startswith(r"\x1b]0;owned\x07\x1b[2J\x9b31m\u202e\x0d")
    assert escaped("α\tβ\n") == "α\tβ\n"


def test_messages_are_cut(capsys):
    complain("x" * 5000, "y" * 5000)
    printed = capsys.readouterr().err
    assert len(printed) <= LONGEST_MESSAGE + len("surmount: \n\n")
    assert printed.count("…") == 2


def files_with(text: str, folder: Path) -> dict[str, list[str]]:
    """Return calls whose errors quote a key, a cell, a path or a module."""
    (folder / "keys.json").write_text(json.dumps({text: 1}), encoding="utf-8")
    (folder / "deep.json").write_text(
        json.dumps({"kind": "surmount curriculum", "schema": 1, text: 1}), encoding="utf-8"
    )
    trials = two_behaviours()
    write_trials(folder / "name.parquet", replace(trials, parameters=(text,)))
    (folder / "cell.csv").write_text(
        f"variant,network,trial,success,x\n1,0,0,1,{text}\n", encoding="utf-8"
    )
    return {
        "key of a configuration": ["config", "step", "--config", str(folder / "keys.json")],
        "key of a curriculum": ["show", str(folder / "deep.json")],
        "name": ["analyze", str(folder / "name.parquet"), "--out", str(folder / "out")],
        "cell": ["analyze", str(folder / "cell.csv"), "--out", str(folder / "out")],
        "path": ["show", str(folder / text)],
        "module": ["check", f"{text}:make_env"],
        "format": ["export", str(folder / "deep.json"), "--to", text],
        "verb": [text],
    }


@pytest.mark.parametrize("what", [
    "key of a configuration", "key of a curriculum", "name", "cell", "path", "module", "format",
    "verb",
])  # fmt: skip
@pytest.mark.parametrize("text", [ACTING, "long" * 50_000], ids=["acting", "long"])
def test_no_message_passes_on_what_others_wrote(capsys, tmp_path, what, text):
    if what in ("path", "format") and len(text) > 1000:
        pytest.skip("no system takes such a path, and no shell such an option")
    code = run(files_with(text, tmp_path)[what])
    printed = capsys.readouterr().err
    assert code in (1, 2, 3)
    assert printed == escaped(printed)
    assert len(printed) < 1.1 * LONGEST_MESSAGE


def test_a_table_of_texts_of_others_acts_on_no_terminal():
    table = Table(title=ACTING)
    table.add_column(ACTING)
    table.add_row(ACTING)
    file = io.StringIO()
    SafeConsole(file=file, force_terminal=False, width=200).print(table)
    assert file.getvalue() == escaped(file.getvalue())
    assert r"\x1b]0;owned" in file.getvalue()


def test_nothing_prints_past_the_one_place():
    """Every other call of `print` or of rich's console would let characters of others act."""
    package = Path(surmount.__file__).parent
    allowed = {"core/printing.py": "print", "workflow/console.py": "Console"}
    found = [
        (path.relative_to(package).as_posix(), node.func.id)
        for path in package.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id in ("print", "Console")
    ]
    assert [place for place in found if place not in allowed.items()] == []


@pytest.mark.parametrize(
    "variables",
    [
        pytest.param(
            {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}, marks=pytest.mark.slow
        ),
        pytest.param({"PYTHONIOENCODING": "latin-1"}, marks=pytest.mark.slow),
        {"PYTHONIOENCODING": "ascii:strict"},
    ],
    ids=["C", "latin-1", "ascii"],
)
def test_an_output_that_is_not_utf_8_gets_what_it_can_show(tmp_path, variables):
    write_trials(tmp_path / "trials.parquet", two_behaviours())
    options = ["--set", "components=2", "--set", "bootstrap=0", "--out", tmp_path / "out"]
    environment = os.environ | variables
    done = call(
        "analyze", tmp_path / "trials.parquet", *options, env=environment, stdout=subprocess.PIPE
    )
    assert done.returncode == 0, done.stderr
    assert b"How far to trust it" in done.stdout
    done = call("show", tmp_path / "löß", env=environment, stdout=subprocess.PIPE)
    assert done.returncode == 3


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_full_output_is_told_and_the_files_are_there(tmp_path):
    write_trials(tmp_path / "trials.parquet", two_behaviours())
    options = ["--set", "components=2", "--set", "bootstrap=0", "--out", tmp_path / "out"]
    with Path("/dev/full").open("wb") as full:
        done = call("analyze", tmp_path / "trials.parquet", *options, stdout=full)
    assert done.returncode == 4
    assert b"Standard output could not be written (No space left on device)" in done.stderr
    assert (tmp_path / "out" / "curriculum.json").is_file()


@pytest.mark.parametrize("closed", [1, 2])
def test_a_closed_output_is_borne_and_no_file_takes_its_place(closed):
    script = f'"$@" {closed}>&-'
    done = subprocess.run(  # noqa: S603
        ["/bin/sh", "-c", script, "sh", *COMMAND, "tasks" if closed == 1 else BAD],
        capture_output=True,
        check=False,
    )
    assert done.returncode == (0 if closed == 1 else 2)
    assert done.stdout + done.stderr == b""


def test_ctrl_c_while_modules_are_imported_ends_in_a_sentence(tmp_path):
    """A module that takes long to be imported, as on a slow disk."""
    (tmp_path / "tyro.py").write_text(
        "import time\nprint('importing', flush=True)\n"
        "try:\n    time.sleep(600)\nexcept BaseException:\n    raise ImportError('broken')\n",
        encoding="utf-8",
    )
    # A shell that runs the tests in the background lets its children ignore what is sent here.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        process = subprocess.Popen(  # noqa: S603
            [*COMMAND, "tasks"],
            env=os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
    finally:
        signal.signal(signal.SIGINT, before)
    assert process.stdout is not None
    assert process.stdout.readline() == b"importing\n"
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=600)
    assert process.returncode == 130
    assert err == b"surmount: interrupted.\n"
