"""Success against size in every cell of a regime map, with the name of its regime."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import altair as alt
import numpy as np

from surmount.report.document.parts import Chart
from surmount.report.document.text import percent
from surmount.report.figures.charts import figure, frame, layers, seen, shares, styles, x_of
from surmount.report.figures.palette import ARM_STYLES, GRID
from surmount.report.figures.stills import draw, write_still
from surmount.workflow.run_layout import CONTROL, CURRICULUM

HEIGHT_PX = 150
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
    write_still(folder, "regimes", draw(_draw(record)), columns)


def _draw(record: Mapping[str, Any]) -> Chart:
    down, across = record["axes"]
    panels = [_panel(cell, down, across, record) for cell in record["cells"]]
    return figure(panels, columns=len(across["values"]), least_px=220)


def _panel(
    cell: Mapping[str, Any],
    down: Mapping[str, Any],
    across: Mapping[str, Any],
    record: Mapping[str, Any],
) -> alt.LayerChart:
    look = list(ARM_STYLES.values())
    low, high = record["hard"][0] - 0.5, record["hard"][1] + 0.5
    hard = alt.Chart(frame({"x": [low], "x2": [high], "told": ["the hard variants"]}))
    layer = [
        hard.mark_rect(color=GRID).encode(
            x_of("x", "size in mm (grey: the hard variants)", axis=alt.Axis(tickCount=5)),
            x2="x2:Q",
            tooltip=alt.Tooltip("told:N", title="grey"),
        )
    ]
    lines: dict[str, list[object]] = {name: [] for name in ("x", "y", "series", "curve", "success")}
    means: dict[str, list[object]] = {name: [] for name in ("x", "y", "series", "success")}
    above: dict[str, list[object]] = {name: [] for name in ("x", "y", "series")}
    sizes = [float(size) for size in cell.get("variants", [])]
    for kind, matrix in cell.get("success", {}).items():
        name = ARM_STYLES[kind].name
        for network, rates in enumerate(matrix):
            lines["x"] += sizes
            lines["y"] += rates
            lines["series"] += [name] * len(sizes)
            lines["curve"] += [f"{kind} {network}"] * len(sizes)
            lines["success"] += [percent(rate, 1) for rate in rates]
        mean = np.mean(matrix, axis=0)
        means["x"] += sizes
        means["y"] += mean.tolist()
        means["series"] += [name] * len(sizes)
        means["success"] += [percent(rate, 1) for rate in mean.tolist()]
        if kind in LANES:
            solved = [size for size, rate in zip(sizes, mean, strict=True)
                      if rate >= record["solved"]]  # fmt: skip
            above["x"] += solved
            above["y"] += [LANES[kind]] * len(solved)
            above["series"] += [name] * len(solved)
    y = shares("success (thick: mean of networks)", top=1.25, bottom=-0.04)
    told = styles(look, "color", "strokeDash")
    if means["x"]:
        layer += [
            alt.Chart(frame(lines))
            .mark_line(strokeWidth=0.7)
            .encode(alt.X("x:Q"), y, detail="curve:N", opacity=seen(0.55), **told),
            alt.Chart(frame(means))
            .mark_line()
            .encode(alt.X("x:Q"), alt.Y("y:Q"), opacity=seen(), **told),
        ]
    if above["x"]:
        layer.append(
            alt.Chart(frame(above))
            .mark_point(filled=True, size=14)
            .encode(alt.X("x:Q"), alt.Y("y:Q"), opacity=seen(), **styles(look, "color", "shape"))
        )
    values = ", ".join(
        f"{_leaf(axis['key'])} = {value}"
        for axis, value in zip((down, across), cell["values"], strict=True)
    )
    return layers(*layer, height=HEIGHT_PX, title=[cell.get("regime", "not run"), values])


def _leaf(key: str) -> str:
    return key.rsplit(".", 1)[-1]
