"""``surmount initiations``: success after the initiation under many settings, against table 1."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import tyro

from surmount.cli.main import INTERRUPTED
from surmount.cli.workers import WorkerOptions, Workers

MAP = "initiations.json"


def initiations(
    settings: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE.toml")],
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")],
    workers: WorkerOptions = Workers(),  # noqa: B008 - frozen
) -> int:
    """Train initial networks under many settings and compare their success with table 1.

    Writes initiations.json and a figure. Calling it again goes on where it stopped, and settings
    may be added to the file meanwhile: what is finished is kept.

    Args:
        settings: TOML file with a table [common] and one [settings.NAME] per setting.
        out: Folder for networks, trials and the map.
        workers: Where stages run.
    """
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
    for name, setting in record["settings"].items():
        distance = setting["distance"]
        console.print(
            f"{name}: " + ("incomplete" if distance is None else f"{distance:.3f} from table 1"),
            highlight=False,
        )
    if outcome.interrupted:
        console.print("Stopped. Go on with the same command.")
        return INTERRUPTED
    return 0
