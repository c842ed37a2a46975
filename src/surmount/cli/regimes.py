"""``surmount regimes``: where the curriculum helps, over a grid of two settings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import tyro
from rich.table import Table

from surmount.cli.main import INTERRUPTED
from surmount.cli.part_progress import PartProgress
from surmount.cli.workers import WorkerOptions, Workers

MAP = "regimes.json"


def regimes(
    map: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE.toml")],  # noqa: A002
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")],
    workers: WorkerOptions = Workers(),  # noqa: B008 - frozen
) -> int:
    """Run curriculum and control over a grid of two settings and say where which succeeds.

    Writes regimes.json and a figure. Calling it again goes on where it stopped, and values may be
    added to the axes meanwhile: what is finished is kept.

    Args:
        map: TOML file with obstacle, hard, solved, a table [common] and a table [axes].
        out: Folder for networks, trials and the map.
        workers: Where stages run.
    """
    with PartProgress() as telling:
        telling(f"reading {map}")
        # After the first line: what learns takes seconds to import.
        from surmount.core.records import write_record
        from surmount.studies.regime_figure import write_regime_figure
        from surmount.studies.regime_map import read_regime_map, regime_stages, summarise_regimes
        from surmount.workflow.console import SafeConsole
        from surmount.workflow.progress import run_graph
        from surmount.workflow.provenance import provenance
        from surmount.workflow.store import output_errors, sole_user

    workers.checked()
    chosen = read_regime_map(map)
    graph = regime_stages(chosen)
    console = SafeConsole()
    with sole_user(out):
        outcome = run_graph(
            out, graph, workers.make, console, store=workers.store, retries=workers.retries
        )
        record: dict[str, Any] = {
            "kind": "regime map",
            "schema": 1,
            **provenance(),
            "obstacle": chosen.obstacle,
            "axes": [{"key": axis.key, "values": list(axis.values)} for axis in chosen.axes],
            "hard": list(chosen.hard),
            "solved": chosen.solved,
            "cells": summarise_regimes(chosen, outcome.artefacts),
        }
        with output_errors(out):
            write_record(out / MAP, record)
            write_regime_figure(record, out)
    console.print(_table(record, [axis.name for axis in chosen.axes]))
    if outcome.interrupted:
        console.print("Stopped. Go on with the same command.")
        return INTERRUPTED
    return 0


def _table(record: dict[str, Any], axes: list[str]) -> Table:
    from surmount.workflow.run_layout import TRAININGS

    table = Table(title="Success in % on the hard variants (on all)", title_justify="left")
    for column in (*axes, *TRAININGS, "who succeeds"):
        table.add_column(column)
    for cell in record["cells"]:
        table.add_row(
            *map(str, cell["values"]),
            *(_shares(cell, kind) for kind in TRAININGS),
            cell.get("regime", "not run"),
        )
    return table


def _shares(cell: dict[str, Any], kind: str) -> str:
    if "regime" not in cell:
        return ""
    hard, everything = (cell[part]["success"][kind] for part in ("hard", "all"))
    return f"{100 * hard:.0f} ({100 * everything:.0f})"
