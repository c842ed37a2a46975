"""Success against size in every cell of a regime map, with the name of its regime."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surmount.report.figures.palette import ARM_STYLES, GRID, INK, MUTED
from surmount.report.figures.stills import axes_grid, draw, write_still
from surmount.workflow.run_layout import CONTROL, CURRICULUM

ROW_IN = 1.75
"""Height of a row of the figure in inches."""
LANES = {CURRICULUM: 1.18, CONTROL: 1.09}
"""Where marks stand above the curves for the sizes on which an arm succeeds."""


def write_regime_figure(record: Mapping[str, Any], folder: Path) -> None:
    """Draw a regime map and write ``regimes.svg``, ``.png`` and ``.csv``.

    Parameters
    ----------
    record
        The map: ``axes`` (two, each with ``key`` and ``values``), ``hard``, ``solved`` and
        ``cells`` as :func:`surmount.studies.regime_map.summarise_regimes` returns them.
    folder
        Where the files go.
    """
    rows = [
        (*cell["values"], stage, network, variant, share)
        for cell in record["cells"]
        for stage, matrix in cell.get("success", {}).items()
        for network, shares in enumerate(matrix)
        for variant, share in zip(cell["variants"], shares, strict=True)
    ]
    keys = [axis["key"] for axis in record["axes"]]
    names = (*keys, "training", "network", "variant", "success")
    columns = {name: [row[index] for row in rows] for index, name in enumerate(names)}
    write_still(folder, "regimes", draw(lambda: _draw(record)), columns)


def _draw(record: Mapping[str, Any]) -> Figure:
    down, across = record["axes"]
    n_rows, n_columns = len(down["values"]), len(across["values"])
    figure, axes = axes_grid(
        n_rows, n_columns, height_in=0.7 + ROW_IN * n_rows, share_y=True, share_x=True
    )
    for index, (axis, cell) in enumerate(zip(axes, record["cells"], strict=True)):
        row, column = divmod(index, n_columns)
        _draw_cell(axis, cell, record["hard"], record["solved"])
        if column == 0:
            axis.set_ylabel(f"{_leaf(down['key'])} = {cell['values'][0]}", fontsize=7.5)
        if row == n_rows - 1:
            axis.set_xlabel(f"{_leaf(across['key'])} = {cell['values'][1]}", fontsize=7.5)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=len(labels))
    figure.supylabel("success (thick: mean over networks)", fontsize=8)
    legend = f"marks above: sizes on which at least {100 * record['solved']:.0f} % succeed"
    figure.supxlabel(f"size in mm (grey: the hard variants, {legend})", fontsize=8)
    return figure


def _draw_cell(axis: Axes, cell: Mapping[str, Any], hard: Sequence[float], solved: float) -> None:
    axis.set_ylim(-0.04, 1.25)
    axis.set_yticks([0.0, 0.5, 1.0])
    axis.axvspan(hard[0] - 0.5, hard[1] + 0.5, color=GRID, zorder=0)
    axis.set_title(cell.get("regime", "not run"), color=INK if "regime" in cell else MUTED)
    sizes = np.asarray(cell.get("variants", []))
    for kind, style in ARM_STYLES.items():
        rates = np.asarray(cell.get("success", {}).get(kind, np.empty((0, 0))))
        for network in rates:
            axis.plot(sizes, network, color=style.colour, lw=0.5, alpha=0.5)
        mean = rates.mean(axis=0) if rates.size else np.empty(0)
        axis.plot(sizes, mean, color=style.colour, ls=style.line, label=style.name, lw=1.8)
        if kind in LANES:
            above = sizes[mean >= solved]
            lane = np.full(above.size, LANES[kind])
            axis.plot(above, lane, style.point, color=style.colour, ms=2.2, mew=0)


def _leaf(key: str) -> str:
    return key.rsplit(".", 1)[-1]
