"""A list of all decisions, from their titles."""

from __future__ import annotations

import re
from pathlib import Path

import pages
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files

DOCS = Path(__file__).parents[1]
DECISIONS = sorted((DOCS / "adr").glob("[0-9]*.md"))
INTRODUCTION = """# Decisions

Choices that somebody may reverse, each with what spoke for it and against it.

"""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """List the decisions."""
    pages.expand(config.nav, "adr/", ["adr/README.md", *(f"adr/{one.name}" for one in DECISIONS)])
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the list."""
    lines = [f"* [{_title(path)}]({path.name})" for path in DECISIONS]
    return pages.add(files, config, {"adr/README.md": INTRODUCTION + "\n".join(lines) + "\n"})


def _title(path: Path) -> str:
    found = re.match(r"# (.+)", path.read_text(encoding="utf-8"))
    return found.group(1) if found else path.stem
