"""Success after the initiation by size, for many settings, beside the paper's groups."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from surmount.report.figures.palette import INK, MUTED
from surmount.report.figures.stills import axes_grid, draw, write_still

OBSTACLES = ("narrow-channel", "low-entrance", "step")
ROW_IN = 1.25
"""Height of a row of the figure in inches."""
COLUMNS = 5
"""Plots side by side where there is one obstacle alone."""
LABEL_CHARACTERS = 18
"""Length of a line beside a row of the figure: more is higher than the row."""


def write_initiation_figure(record: Mapping[str, Any], folder: Path) -> None:
    """Draw a map of initiations and write ``initiations.svg``, ``.png`` and ``.csv``.

    Parameters
    ----------
    record
        The map, with ``settings`` as :func:`surmount.studies.initiation_map.summarise` returns
        them.
    folder
        Where the files go.
    """
    files = draw(lambda: _draw(record["settings"]))
    rows = [
        (name, obstacle, network, variant, share)
        for name, setting in record["settings"].items()
        for obstacle, found in setting["obstacles"].items()
        for network, shares in enumerate(found["success"])
        for variant, share in zip(found["variants"], shares, strict=True)
    ]
    names = ("setting", "obstacle", "network", "variant_mm", "success")
    columns = {name: [row[index] for row in rows] for index, name in enumerate(names)}
    write_still(folder, "initiations", files, columns)


def _draw(settings: Mapping[str, Any]) -> Figure:
    shown = [name for name in OBSTACLES if any(name in s["obstacles"] for s in settings.values())]
    if len(shown) == 1:
        figure = _small_multiples(settings, shown[0])
    else:
        figure = _table_of_plots(settings, shown or [*OBSTACLES])
    figure.supylabel("success after the initiation\n(dashed: the paper's groups)", fontsize=8)
    return figure


def _small_multiples(settings: Mapping[str, Any], obstacle: str) -> Figure:
    """Return one plot per setting in reading order, all of one obstacle."""
    columns = min(COLUMNS, len(settings))
    rows = -(-len(settings) // columns)
    figure, axes = axes_grid(
        rows, columns, height_in=0.8 + ROW_IN * rows, used=len(settings), share_y=True, share_x=True
    )
    for index, (axis, (name, setting)) in enumerate(zip(axes, settings.items(), strict=True)):
        axis.set_title(name, fontsize=7)
        if index + columns >= len(settings):  # nothing below
            axis.set_xlabel(f"{obstacle}, mm")
            axis.tick_params(labelbottom=True)
        _plot(axis, setting["obstacles"].get(obstacle))
    return figure


def _table_of_plots(settings: Mapping[str, Any], obstacles: list[str]) -> Figure:
    """Return a row of plots per setting, a column per obstacle."""
    count = len(settings)
    figure, axes = axes_grid(count, len(obstacles), height_in=0.8 + ROW_IN * count, share_y=True)
    for row, (name, setting) in enumerate(settings.items()):
        for column, obstacle in enumerate(obstacles):
            axis = axes[row * len(obstacles) + column]
            if row == 0:
                axis.set_title(obstacle)
            if row == count - 1:
                axis.set_xlabel("size in mm")
            _plot(axis, setting["obstacles"].get(obstacle))
        axes[row * len(obstacles)].set_ylabel(textwrap.fill(name, LABEL_CHARACTERS), fontsize=7)
    return figure


def _plot(axis: Axes, found: Mapping[str, Any] | None) -> None:
    axis.set_ylim(-0.04, 1.04)
    if found is None:
        axis.text(0.5, 0.5, "not run", ha="center", color=MUTED, transform=axis.transAxes)
        return
    variants, success = np.array(found["variants"]), np.array(found["success"])
    for network in success:
        axis.plot(variants, network, color=MUTED, lw=0.7)
    axis.plot(variants, success.mean(axis=0), color=INK, lw=1.6)
    for group in found["groups"]:
        axis.plot(
            [group["low_mm"], group["high_mm"]],
            [group["paper"]] * 2,
            color="#D55E00",
            lw=1.4,
            ls=(0, (2, 1)),
        )
