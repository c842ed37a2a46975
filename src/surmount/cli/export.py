"""``surmount export``: a curriculum or a network for another framework."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import tyro

from surmount.core.errors import ConfigError
from surmount.core.printing import say
from surmount.core.records import write_atomically
from surmount.exports.formats import FORMATS, export_curriculum
from surmount.exports.ml_agents import export_ml_agents
from surmount.tasks.curriculum import Curriculum
from surmount.workflow.opening import opened
from surmount.workflow.store import output_errors

NETWORK_FORMATS = {"onnx": "policy.onnx", "acting": "acting.safetensors"}
"""Formats of networks, and the files they are written to."""


def export(
    file: Annotated[Path, tyro.conf.Positional],
    *,
    to: Annotated[str, tyro.conf.arg(metavar=f"{{{','.join((*FORMATS, *NETWORK_FORMATS))}}}")],
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")] = Path(),
    behavior: str | None = None,
    threshold: float | None = None,
) -> int:
    """Write a curriculum or a network for others, and say what the format cannot express.

    Args:
        file: A curriculum.json, or a network.safetensors.
        to: Of a curriculum: ml-agents (YAML), syllabus or sb3 (a Python file each), csv. Of a
            network: onnx, or acting (the same file without what only learning needs).
        out: Folder for the files.
        behavior: For ml-agents: name of the behaviour in Unity; Robot if not given.
        threshold: For ml-agents: share of max_steps after which the last lesson begins; a half if
            not given.
    """
    options: dict[str, Any] = {
        name: value
        for name, value in (("behavior", behavior), ("threshold", threshold))
        if value is not None
    }
    if options and to != "ml-agents" and to in (*FORMATS, *NETWORK_FORMATS):
        raise ConfigError(
            f"`--to {to}` does not use {' and '.join(f'`--{name}`' for name in options)}.",
            remedy="Leave it out, or give --to ml-agents.",
        )
    if to in NETWORK_FORMATS and file.suffix == ".json":
        raise ConfigError(
            f"{file} is no network, and `{to}` takes networks.",
            remedy=f"Give --to {' or '.join(FORMATS)}, or a network.safetensors.",
        )
    if to in NETWORK_FORMATS or file.suffix == ".safetensors":
        return _export_network(file, to, out)
    curriculum = Curriculum.load(opened(file))
    if to == "ml-agents":
        made = export_ml_agents(curriculum, **options)
    else:
        made = export_curriculum(curriculum, to)
    with output_errors(out):
        for name, text in made.files.items():
            write_atomically(out / name, text.encode())
    say(f"Written to {out}: {', '.join(made.files)}")
    for note in made.notes:
        say(f"  {note}")
    return 0


def _export_network(file: Path, to: str, out: Path) -> int:
    # A curriculum goes to other frameworks without these.
    from surmount.experiment.network_export import export_network_onnx
    from surmount.learn.snapshot import Snapshot, acting_only

    if to not in NETWORK_FORMATS:
        raise ConfigError(
            f"{file} is a network, and `{to}` takes curricula.",
            remedy=f"Give --to {' or '.join(NETWORK_FORMATS)}, or a curriculum.json.",
        )
    network = Snapshot.load(opened(file))
    path = out / NETWORK_FORMATS[to]
    with output_errors(out):
        out.mkdir(parents=True, exist_ok=True)
        if to == "onnx":
            export_network_onnx(network, file, path)
        else:
            acting_only(network).save(path)
    say(f"Written to {path}: {path.stat().st_size:,} bytes")
    return 0
