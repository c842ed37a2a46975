"""Success after the initiation by size, for many settings, beside the paper's groups."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from surmount.report.palette import INK, MUTED
from surmount.report.stills import axes_grid, draw, write_still

OBSTACLES = ("narrow-channel", "low-entrance", "step")
ROW_IN = 1.25
"""Height of a row of the figure in inches."""


def write_initiation_figure(record: Mapping[str, Any], folder: Path) -> None:
    """Draw a map of initiations and write ``initiations.svg``, ``.png`` and ``.csv``.

    Parameters
    ----------
    record
        The map, with ``settings`` as :func:`surmount.experiment.initiation_map.summarise` returns
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
    count = len(settings)
    figure, axes = axes_grid(count, len(OBSTACLES), height_in=0.8 + ROW_IN * count, share_y=True)
    for row, (name, setting) in enumerate(settings.items()):
        for column, obstacle in enumerate(OBSTACLES):
            axis = axes[row * len(OBSTACLES) + column]
            found = setting["obstacles"].get(obstacle)
            axis.set_ylim(-0.04, 1.04)
            if row == 0:
                axis.set_title(obstacle)
            if row == count - 1:
                axis.set_xlabel("size in mm")
            if found is None:
                axis.text(0.5, 0.5, "not run", ha="center", color=MUTED, transform=axis.transAxes)
                continue
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
        axes[row * len(OBSTACLES)].set_ylabel(name, fontsize=7)
    figure.supylabel("success after the initiation (dashed: the paper's groups)", fontsize=8)
    return figure
