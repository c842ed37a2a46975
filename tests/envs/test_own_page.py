"""The page on one's own environment runs as it stands."""

from __future__ import annotations

import re
from pathlib import Path

from surmount.cli.main import VERBS
from surmount.envs.check import check_contract

DOCS = Path(__file__).parents[2] / "docs"


def test_the_example_runs_and_keeps_the_contract():
    text = (DOCS / "own-environment.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    space: dict = {}
    exec(compile(block, "own-environment.md", "exec"), space)  # noqa: S102
    assert [found for found in check_contract(space["make_env"]) if not found.holds] == []


def test_commands_exist():
    for name in ("own-environment.md", "exports.md"):
        text = (DOCS / name).read_text(encoding="utf-8")
        verbs = re.findall(r"^\$ surmount ([a-z]+)", text, flags=re.MULTILINE)
        assert verbs
        assert set(verbs) <= set(VERBS)
