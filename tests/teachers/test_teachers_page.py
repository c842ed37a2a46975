"""The page on teachers names each of them with its settings, and its example runs."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

from surmount.experiment.teaching import SETTINGS
from surmount.teachers.catalogue import TEACHERS, TeachersConfig

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "teachers.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| `([\w-]+)` \|.*?\|(.*?)\|(.*?)\|$", PAGE, flags=re.MULTILINE)


def test_every_teacher_has_a_row_with_its_settings():
    assert [name for name, _, _ in ROWS] == [*TEACHERS]
    for name, source, settings in ROWS:
        assert re.findall(r"\d{4}", source) in ([], re.findall(r"\d{4}", TEACHERS[name].source))
        known = getattr(TeachersConfig(), SETTINGS[name], None) if name in SETTINGS else None
        expected = [field.name for field in fields(known)] if known is not None else []
        assert re.findall(r"`(\w+)`", settings) == expected


def test_the_example_runs():
    (block,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    space: dict = {}
    exec(compile(block, "teachers.md", "exec"), space)  # noqa: S102
    assert space["teacher"].status().steps == 2_000
    assert len(space["state"]["returns"]) == 200


def test_links_lead_somewhere():
    targets = re.findall(r"\]\(([^)#]+)\)", PAGE)
    assert targets
    for target in targets:
        assert (DOCS / target).is_file(), target
