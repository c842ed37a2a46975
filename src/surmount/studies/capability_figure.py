"""The capability map as a figure: which sizes scripted manoeuvres overcome, for each physics."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from surmount.report.figures.palette import INK, MUTED
from surmount.report.figures.stills import axes_grid, draw, write_still

HARDEST_MM = {"narrow-channel": 180.0, "low-entrance": 55.0, "step": 50.0}
"""The paper's hardest variants (III-C)."""


def write_capability_figure(record: Mapping[str, Any], folder: Path) -> None:
    """Draw a capability map and write ``capability.svg``, ``.png`` and ``.csv``.

    Parameters
    ----------
    record
        The map, as :func:`surmount.studies.capability.map_capability` returns it.
    folder
        Where the files go.
    """
    files = draw(lambda: _draw(record))
    cells = [(column, cell) for column in record["columns"] for cell in column["cells"]]
    table = {
        **{
            name: [column[name] for column, _ in cells]
            for name in ("gear", "friction", "torque_factor")
        },
        **{name: [cell[name] for _, cell in cells] for name in ("size_mm", "feasible", "tried")},
    }
    write_still(folder, "capability", files, table)


def _draw(record: Mapping[str, Any]) -> Figure:
    columns = sorted(record["columns"], key=_order)
    gears = list(dict.fromkeys(column["gear"] for column in columns))
    obstacle = record["config"]["obstacle"]
    by_gear = {
        gear: [column for column in columns if column["gear"] == gear] for gear in gears
    } or {"": []}
    figure, axes = axes_grid(
        1,
        len(by_gear),
        height_in=3.4,
        share_y=True,
        width_ratios=[len(of_gear) + 1 for of_gear in by_gear.values()],
    )
    for axis, (gear, of_gear) in zip(axes, by_gear.items(), strict=True):
        for place, column in enumerate(of_gear):
            sizes = np.array([cell["size_mm"] for cell in column["cells"]])
            feasible = np.array([cell["feasible"] for cell in column["cells"]])
            axis.plot(np.full(int(feasible.sum()), place), sizes[feasible], "s", color=INK, ms=5)
            missed = sizes[~feasible]
            axis.plot(
                np.full(missed.size, place), missed, "s", mfc="white", mec=MUTED, mew=1.0, ms=5
            )
        axis.axhline(HARDEST_MM[obstacle], color=MUTED, lw=0.8, ls="--")
        axis.set_xticks(range(len(of_gear)), [_tick(column) for column in of_gear])
        axis.set_xlim(-0.6, len(of_gear) - 0.4)
        axis.set_title(gear)
        scaled = any(column["torque_factor"] != 1 for column in of_gear)
        axis.set_xlabel("friction, below it the factor on torques" if scaled else "friction")
    axes[0].set_ylabel("size in mm")
    figure.legend(
        handles=[
            Line2D([], [], ls="", marker="s", color=INK, label="manoeuvre found"),
            Line2D([], [], ls="", marker="s", mfc="white", mec=MUTED, label="none found"),
            Line2D([], [], color=MUTED, lw=0.8, ls="--", label="paper's hardest"),
        ],
        loc="outside lower center",
        ncols=3,
    )
    return figure


def _order(column: Mapping[str, Any]) -> tuple[int, float, float]:
    plainest_first = ("wheels", "whegs", "both")
    return (
        plainest_first.index(column["gear"]),
        column["torque_factor"],
        column["friction"],
    )


def _tick(column: Mapping[str, Any]) -> str:
    factor = column["torque_factor"]
    return f"{column['friction']:g}" + ("" if factor == 1 else f"\n×{factor:g}")
