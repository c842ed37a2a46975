"""Pages that are made when the site is built, and their places in the navigation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files


def add(files: Files, config: MkDocsConfig, pages: Mapping[str, str]) -> Files:
    """Add pages, by their path within the documentation."""
    for path, text in pages.items():
        files.append(File.generated(config, path, content=text))
    return files


def expand(nav: list[Any], place: str, entries: list[Any]) -> None:
    """Put a list of pages where the navigation names their folder."""
    for item in nav:
        if not isinstance(item, dict):
            continue
        ((title, below),) = item.items()
        if below == place:
            item[title] = entries
        elif isinstance(below, list):
            expand(below, place, entries)
