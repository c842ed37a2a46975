"""Every notebook runs from its first cell to its last, and is kept without results."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest
from small import SMALL

DOCS = Path(__file__).parent.parent / "docs"
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))
FAST = "from-logs-to-a-curriculum"
SMALLEST = f'task, preset, changes = "rstar/low-entrance", "smoke", {SMALL!r}'


def read(path: Path) -> nbformat.NotebookNode:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    return notebook


def test_there_are_four():
    assert len(NOTEBOOKS) == 4


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_is_kept_without_results(path):
    cells = read(path).cells
    assert cells[0].source.startswith("# ")
    for cell in cells:
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=[] if path.stem == FAST else pytest.mark.slow, id=path.stem)
        for path in NOTEBOOKS
    ],
)
def test_it_runs(path, tmp_path, monkeypatch):
    notebook = read(path)
    for cell in notebook.cells:
        if "parameters" in cell.metadata.get("tags", ()):  # its own scale takes an hour
            cell.source = SMALLEST
    monkeypatch.syspath_prepend(str(DOCS / "site"))
    import notebooks  # noqa: PLC0415 - the site's, found by its folder

    notebooks.run(notebook, tmp_path)
    assert all(cell.execution_count for cell in notebook.cells if cell.cell_type == "code")
