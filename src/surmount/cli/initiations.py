"""``surmount initiations``: success after the initiation under many settings, and their scores."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import tyro

from surmount.cli.main import INTERRUPTED
from surmount.cli.part_progress import PartProgress
from surmount.cli.workers import WorkerOptions, Workers

MAP = "initiations.json"


def initiations(
    settings: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE.toml")],
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")],
    workers: WorkerOptions = Workers(),  # noqa: B008 - frozen
) -> int:
    """Train initial networks under many settings and score them by the paper's success.

    The score is that of docs/adr/0023: the logarithm of the probability that two more networks show
    what the paper prints. Writes initiations.json and a figure. Calling it again goes on where it
    stopped, and settings may be added to the file meanwhile: what is finished is kept.

    Args:
        settings: TOML file with a table [common] and one [settings.NAME] per setting.
        out: Folder for networks, trials and the map.
        workers: Where stages run.
    """
    with PartProgress() as telling:
        telling(f"reading {settings}")
        # After the first line: what learns takes seconds to import.
        from surmount.core.records import write_record
        from surmount.studies.initiation_figure import write_initiation_figure
        from surmount.studies.initiation_map import initiation_stages, read_settings, summarise
        from surmount.workflow.console import SafeConsole
        from surmount.workflow.progress import run_graph
        from surmount.workflow.provenance import provenance
        from surmount.workflow.store import output_errors, sole_user

    workers.checked()
    chosen = read_settings(settings)
    graph = initiation_stages(chosen)
    console = SafeConsole()
    with sole_user(out):
        outcome = run_graph(
            out, graph, workers.make, console, store=workers.store, retries=workers.retries
        )
        record: dict[str, Any] = {
            "kind": "initiation map",
            "schema": 1,
            **provenance(),
            "changes": {setting.name: dict(setting.changes) for setting in chosen},
            "settings": summarise(chosen, outcome.artefacts),
        }
        with output_errors(out):
            write_record(out / MAP, record)
            write_initiation_figure(record, out)
    console.print(_table(record["settings"]))
    if outcome.interrupted:
        console.print("Stopped. Go on with the same command.")
        return INTERRUPTED
    return 0


def _table(settings: dict[str, Any]) -> Any:
    """Return the settings by score, best first; those that are out or have no score come last."""
    from rich.table import Table

    table = Table("setting", "obstacle", "networks", "success, by group", "score", "")
    unscored = -math.inf
    ranked = sorted(
        settings.items(),
        key=lambda named: (
            named[1]["out"] is None,
            unscored if named[1]["score"] is None else named[1]["score"],
        ),
        reverse=True,
    )
    for name, setting in ranked:
        for obstacle, found in setting["obstacles"].items():
            scored = found.get("score")
            table.add_row(
                name,
                obstacle,
                str(len(found["networks"])),
                ", ".join(f"{group['mean']:.2f}" for group in found["groups"]),
                "" if scored is None else f"{scored['log_likelihood']:.2f}",
                "" if setting["out"] is None else f"out: {setting['out']}",
            )
    return table
