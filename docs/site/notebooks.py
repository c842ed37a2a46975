"""Pages from notebooks: run when the site is built, since notebooks are kept without results.

Those whose ``metadata.surmount.minutes`` is more than one are shown as they are. What was run is
kept in ``out/notebooks`` by a hash of the notebook and of the sources.
"""

from __future__ import annotations

import base64
import hashlib
import html
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pages
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from nbclient import NotebookClient
from traitlets.config import Config

DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))
KEPT = ROOT / "out" / "notebooks"
STILL = """import altair
altair.renderers.enable("svg")"""
"""Charts as pictures: as they are in Jupyter they would fetch what draws them from a network."""
FIGURE = '<div class="output">{}</div>'


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Put the pages where the navigation names the notebooks."""
    _rename(config.nav)
    return config


def _rename(nav: list[Any]) -> None:
    for index, item in enumerate(nav):
        if isinstance(item, str):
            nav[index] = item.replace(".ipynb", ".md")
        elif isinstance(item, dict):
            for below in item.values():
                _rename(below) if isinstance(below, list) else None


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page for each notebook."""
    made = {f"notebooks/{path.stem}.md": page(path) for path in NOTEBOOKS}
    return pages.add(files, config, made)


def page(path: Path) -> str:
    """Return the page of one notebook."""
    notebook = nbformat.read(path, as_version=4)
    minutes = notebook.metadata["surmount"]["minutes"]
    if minutes <= 1:
        notebook = _run(path)
        told = "Everything below was run when this page was made."
    else:
        told = f"It takes about {minutes} minutes, and is shown without its results."
    first, *cells = notebook.cells
    lines = [first.source, "", f"*A notebook: [download it]({path.name}). {told}*"]
    for cell in cells:
        lines += ["", cell.source if cell.cell_type == "markdown" else _code(cell.source)]
        if "quiet" in cell.metadata.get("tags", ()):
            continue
        for output in cell.get("outputs", ()):
            lines += _shown(output)
    return "\n".join(lines) + "\n"


def _code(source: str) -> str:
    return f"```python\n{source}\n```"


def _shown(output: Any) -> Iterator[str]:
    """Yield the lines of one result: the richest form that a page can show by itself."""
    if output.output_type == "error":
        raise ValueError("\n".join(output.traceback))
    if output.output_type == "stream":
        if output.name == "stdout":
            yield from ("", f"```text\n{output.text.rstrip()}\n```")
        return
    data = output.data
    if "image/svg+xml" in data:
        yield from ("", FIGURE.format(_inline(data["image/svg+xml"])))
    elif "image/png" in data:
        yield from ("", FIGURE.format(_image("image/png", data["image/png"])))
    elif "text/html" in data:
        yield from ("", FIGURE.format(data["text/html"].replace("\n\n", "\n")))
    else:
        yield from ("", f"```text\n{data['text/plain']}\n```")


def _inline(svg: str) -> str:
    return _image("image/svg+xml", base64.b64encode(svg.encode()).decode())


def _image(kind: str, data: str) -> str:
    return f'<img alt="{html.escape("What the code above shows")}" src="data:{kind};base64,{data}">'


def run(notebook: Any, folder: Path) -> None:
    """Run a notebook in a folder, and put what it gives into it.

    The kernel is talked to through files, not through ports that others could listen at.
    """
    with tempfile.TemporaryDirectory(prefix="kernel-") as sockets:
        config = Config({"KernelManager": {"transport": "ipc", "ip": f"{sockets}/at"}})
        where = {"metadata": {"path": str(folder)}}
        NotebookClient(notebook, resources=where, timeout=1800, config=config).execute()


def _run(path: Path) -> Any:
    kept = KEPT / f"{path.stem}-{_hash(path)}.ipynb"
    if not kept.exists():
        notebook = nbformat.read(path, as_version=4)
        KEPT.mkdir(parents=True, exist_ok=True)
        work = KEPT / path.stem
        work.mkdir(exist_ok=True)
        notebook.cells.insert(0, nbformat.v4.new_code_cell(STILL))
        run(notebook, work)
        del notebook.cells[0]
        nbformat.write(notebook, kept)
    return nbformat.read(kept, as_version=4)


def _hash(path: Path) -> str:
    digest = hashlib.sha256(path.read_bytes())
    for source in sorted((ROOT / "src").rglob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:12]
