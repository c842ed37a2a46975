"""What the README shows runs as it stands."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from example_trials import two_behaviours

from surmount.cli.main import run
from surmount.trials.table import write_trials

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
COMMANDS = re.findall(r"^\$ surmount ([a-z]+)", README, flags=re.MULTILINE)


@pytest.mark.parametrize("block", BLOCKS)
def test_python_blocks_run(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_trials(tmp_path / "trials.csv", two_behaviours())
    exec(compile(block, "README.md", "exec"), {})  # noqa: S102


@pytest.mark.parametrize("verb", sorted(set(COMMANDS)))
def test_commands_exist(verb, capsys):
    with pytest.raises(SystemExit) as ended:
        run([verb, "--help"])
    assert ended.value.code == 0
    assert "usage: surmount" in capsys.readouterr().out.lower()


def test_pictures_exist():
    pictures = re.findall(r"!\[[^]]*\]\(([^)]+)\)", README)
    assert len(pictures) == 4
    for picture in pictures:
        assert (Path(__file__).parent.parent / picture).is_file()
