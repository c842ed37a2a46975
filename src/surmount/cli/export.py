"""``surmount export``: a curriculum for another framework."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from surmount.core.curriculum import Curriculum
from surmount.core.records import write_atomically
from surmount.core.store import output_errors
from surmount.exports import FORMATS, export_curriculum, export_ml_agents


def export(
    file: Annotated[Path, tyro.conf.Positional],
    *,
    to: Annotated[str, tyro.conf.arg(metavar=f"{{{','.join(FORMATS)}}}")],
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")] = Path(),
    behavior: str = "Robot",
    threshold: float = 0.5,
) -> int:
    """Write a curriculum for another framework, and say what its format cannot express.

    Args:
        file: A curriculum.json.
        to: ml-agents (YAML), syllabus or sb3 (a Python file each), csv.
        out: Folder for the files.
        behavior: For ml-agents: name of the behaviour in Unity.
        threshold: For ml-agents: share of max_steps after which the last lesson begins.
    """
    curriculum = Curriculum.load(file)
    if to == "ml-agents":
        made = export_ml_agents(curriculum, behavior=behavior, threshold=threshold)
    else:
        made = export_curriculum(curriculum, to)
    with output_errors(out):
        for name, text in made.files.items():
            write_atomically(out / name, text.encode())
    print(f"Written to {out}: {', '.join(made.files)}")
    for note in made.notes:
        print(f"  {note}")
    return 0
