"""The page on trials of any robot runs as it stands, and shows what it prints."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from surmount import AnalysisConfig
from surmount.analysis.cut import DEFAULT_CUT_OFF
from surmount.cli.main import run

PAGE = (Path(__file__).parent.parent / "docs" / "analysis.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(python|console|text)\n(.*?)```", PAGE, flags=re.DOTALL)


def test_blocks_run_in_their_order_and_print_what_is_shown(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    printed = ""
    for kind, block in BLOCKS:
        if kind == "python":
            exec(compile(block, "analysis.md", "exec"), names)  # noqa: S102
        elif kind == "console":
            for line in block.replace("\\\n", " ").splitlines():
                words = shlex.split(line.removeprefix("$ "), comments=True)
                if words[0] != "pip":
                    capsys.readouterr()
                    assert run(words[1:]) == 0, line
                    printed = capsys.readouterr().out
        else:
            assert printed == block
    listed = re.findall(r"^\| `([a-z.]+)/?` \|", PAGE.partition("## As")[0], flags=re.MULTILINE)
    written = {path.name for path in (tmp_path / "results").iterdir()}
    assert written - {".lock"} == set(listed)
    assert names["cell"].lower.tolist() == [0.775, 0.0]


def test_links_lead_somewhere():
    targets = re.findall(r"\]\(([^)#]+)\)", PAGE)
    assert len(targets) >= 5
    for target in targets:
        if target.startswith("https://"):
            continue
        assert (Path(__file__).parent.parent / "docs" / target).is_file(), target


ROWS = re.findall(r"^\| (`.*?) \| (.*?) \|", PAGE.partition("## Options")[2], flags=re.MULTILINE)
OPTIONS = [
    (name, default)
    for names, defaults in ROWS
    for name, default in zip(re.findall(r"`(\w+)`", names), defaults.split(", "), strict=True)
]
WORDS = {"all logged": "()", "unknown": "()", "the hardest": "()", "on": "True", "1/3": str(1 / 3)}


@pytest.mark.parametrize(("name", "default"), OPTIONS)
def test_defaults_are_those_of_the_configuration(name, default):
    value = getattr(AnalysisConfig(), name)
    if name == "cut_off":
        assert value == 0.0  # takes the rule's
        value = DEFAULT_CUT_OFF["abrupt"]
    text = default.strip("`").removesuffix(" (by BIC)")
    written = WORDS.get(text, text)
    assert written == str(value) or float(written) == value
