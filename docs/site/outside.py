"""Pages from texts and examples outside of the documentation's folder, and links to them.

All texts are also read where the repository is shown, so their links are those of the repository.
The README is the first page.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Any

import pages
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
TEXTS = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
}
"""Texts outside, with their page."""
EXAMPLES = {
    f"examples/{path.name}": f"examples/{path.stem}.md"
    for path in sorted((ROOT / "examples").glob("*.py"))
}
FOLDERS = {
    "docs/adr": "adr/README.md",
    "docs/results": "results/README.md",
    "docs/notebooks": "tutorials.md",
    "examples": "examples/README.md",
}
ORIGIN = {page: source for source, page in (TEXTS | EXAMPLES).items()}
_LINK = re.compile(r"(\[(?:[^][]|\[[^]]*\])*\]\()([^)\s#]+)([^)\s]*\))")
_FENCE = re.compile(r"(^```.*?^```[^\n]*$)", flags=re.DOTALL | re.MULTILINE)


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """List the examples."""
    pages.expand(config.nav, "examples/", ["examples/README.md", *EXAMPLES.values()])
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages."""
    made = {page: (ROOT / source).read_text(encoding="utf-8") for source, page in TEXTS.items()}
    listed = ["# Examples", "", "Programs that run as they stand; the tests run them.", ""]
    for source, page in EXAMPLES.items():
        code = (ROOT / source).read_text(encoding="utf-8")
        name = posixpath.basename(source)
        made[page] = f"# {name}\n\n```python\n{code}```\n"
        told = re.match(r'"""(.*?)(?:\n\n|""")', code, flags=re.DOTALL)
        sentence = " ".join(told.group(1).split()) if told else ""
        listed.append(f"* [`{name}`]({posixpath.basename(page)}): {sentence}")
    made["examples/README.md"] = "\n".join(listed) + "\n"
    return pages.add(files, config, made)


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Turn the repository's links into the site's."""
    here = page.file.src_uri
    folder = posixpath.dirname(ORIGIN.get(here, f"docs/{here}"))

    def turned(link: re.Match[str]) -> str:
        opening, target, closing = link.groups()
        if re.match(r"[a-z]+:", target):
            return link.group()
        source = posixpath.normpath(posixpath.join(folder, target))
        if source.startswith("src/") or (source not in FOLDERS and (ROOT / source).is_dir()):
            return _not_here(link)
        made = (TEXTS | EXAMPLES | FOLDERS).get(source, source.removeprefix("docs/"))
        return opening + posixpath.relpath(made, posixpath.dirname(here) or ".") + closing

    def _not_here(link: re.Match[str]) -> str:
        """Lead to the reference where a public name is meant; sources are not on the site."""
        words = link.group(1)[1:-2]
        public = re.fullmatch(r"`(surmount\.\w+)`", words)
        return f"[{words}][{public.group(1)}]" if public else words

    parts = _FENCE.split(markdown)
    return "".join(part if part.startswith("```") else _LINK.sub(turned, part) for part in parts)
