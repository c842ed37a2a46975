"""Published results: their pages, and beside them the interactive ones that a run draws."""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from typing import Any

import pages
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files, InclusionLevel
from mkdocs.structure.pages import Page

DOCS = Path(__file__).parents[1]
RESULTS = DOCS / "results"
TEXTS = sorted(path.relative_to(DOCS).as_posix() for path in RESULTS.rglob("*.md"))
DRAWN = {
    path.with_suffix(".md").relative_to(DOCS).as_posix(): path
    for path in sorted(RESULTS.rglob("*.html"))
}
"""Pages that a run drew, by the text beside them, whose page would have the same name."""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """List the results."""
    first = "results/README.md"
    pages.expand(config.nav, "results/", [first, *(text for text in TEXTS if text != first)])
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the drawn pages under another name."""
    for text, path in DRAWN.items():
        made = File.generated(
            config, _beside(text), abs_src_path=str(path), inclusion=InclusionLevel.INCLUDED
        )
        files.append(made)
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Lead from a text to the page that was drawn with it."""
    here = page.file.src_uri
    if here.startswith("results/"):
        page.meta.setdefault("search", {"boost": 0.2})  # found after what explains
    if here.endswith("/report.md"):  # pages of many runs have the same title
        heading = markdown.partition("\n")[0].removeprefix("# ")
        page.meta.setdefault("title", f"{heading}: {PurePosixPath(here).parent.name}")
    if here not in DRAWN:
        return markdown
    title, below, rest = markdown.partition("\n")
    name = PurePosixPath(_beside(here)).name
    return f"{title}{below}\n[The same as an interactive page]({name})\n{rest}"


def on_post_build(config: MkDocsConfig) -> None:
    """Leave out the page for addresses that a server does not find: from a folder it is broken."""
    (Path(config.site_dir) / "404.html").unlink(missing_ok=True)


def _beside(text: str) -> str:
    return str(PurePosixPath(text).with_name(f"{PurePosixPath(text).stem}-drawn.html"))
