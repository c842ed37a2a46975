"""One small run and its report, shared by all tests of the room."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import pytest
from run_builder import RunBuilder

from surmount.report.pages import write_report
from surmount.workflow.store import Artefact


@dataclass(frozen=True, kw_only=True)
class Reported:
    """A run folder with its page."""

    root: Path
    page: Path
    stages: dict[str, Artefact]

    def rows(self, figure: str) -> list[dict[str, str]]:
        with (self.root / "figures" / f"{figure}.csv").open(encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def text(self) -> str:
        return self.page.read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def reported(tmp_path_factory) -> Reported:
    root = tmp_path_factory.mktemp("run")
    builder = RunBuilder(root).whole()
    return Reported(root=root, page=write_report(root), stages=builder.artefacts)
