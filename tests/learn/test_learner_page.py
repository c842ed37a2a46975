"""The page on the learner names every field and gives the paper-like one as it is."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

from surmount.core.configuration import override, read_overrides
from surmount.experiment.presets import preset
from surmount.learn.config import LearnerConfig
from surmount.learn.presets import ml_agents_learner

PAGE = (Path(__file__).parents[2] / "docs" / "learner.md").read_text(encoding="utf-8")


def test_its_file_makes_the_paper_like_learner(tmp_path):
    block, *_ = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)
    path = tmp_path / "learner.toml"
    path.write_text(block, encoding="utf-8")
    config = override(preset("step", "paper", calibrated=False), read_overrides(path))
    assert config.learner == ml_agents_learner()


def test_every_field_is_in_its_table():
    lines = PAGE.partition("## Every field")[2].partition("\n## ")[0].splitlines()
    table = "\n".join(line.split("|")[1] for line in lines if line.startswith("| `"))
    named = set(re.findall(r"`([a-z_]+)`", table))
    assert {field.name for field in fields(LearnerConfig)} == named
