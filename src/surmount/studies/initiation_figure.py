"""Success after the initiation by size, for many settings, beside the paper's groups."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import altair as alt
import numpy as np

from surmount.report.document.parts import Chart
from surmount.report.document.text import percent
from surmount.report.figures.charts import figure, frame, layers, seen, shares, styles, words, x_of
from surmount.report.figures.palette import INK, MUTED, Series
from surmount.report.figures.stills import draw, write_still

OBSTACLES = ("narrow-channel", "low-entrance", "step")
HEIGHT_PX = 110
COLUMNS = 5
"""Plots side by side where there is one obstacle alone."""
LABEL_CHARACTERS = 26
"""Length of a line above a plot."""
SERIES = (
    Series(name="one network", colour=MUTED, dash=(1, 0)),
    Series(name="mean", colour=INK, dash=(1, 0)),
    Series(name="the paper's groups", colour="#d55e00", dash=(5, 3)),
)


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
    files = draw(_draw(record["settings"]))
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


def _draw(settings: Mapping[str, Any]) -> Chart:
    shown = [name for name in OBSTACLES if any(name in s["obstacles"] for s in settings.values())]
    obstacles = shown or [*OBSTACLES]
    alone = len(obstacles) == 1
    panels = [
        _panel(
            name if alone else f"{name}: {obstacle}",
            setting["obstacles"].get(obstacle),
            f"{obstacle}, mm",
        )
        for name, setting in settings.items()
        for obstacle in obstacles
    ]
    columns = min(COLUMNS, len(settings)) if alone else len(obstacles)
    return figure(panels, columns=columns, least_px=200)


def _panel(title: str, found: Mapping[str, Any] | None, x_title: str) -> alt.LayerChart:
    look = SERIES
    y = shares("success after the initiation", top=1.04, bottom=-0.04)
    if found is None:
        rows = {"text": ["not run"]}
        middle = words(rows, x=alt.value(50), y=alt.value(HEIGHT_PX / 2), align="center")
        return layers(middle, height=HEIGHT_PX, title=textwrap.wrap(title, LABEL_CHARACTERS))
    variants = [float(variant) for variant in found["variants"]]
    curves = [*found["success"], np.mean(found["success"], axis=0).tolist()]
    lines = frame(
        {
            "x": variants * len(curves),
            "y": [share for curve in curves for share in curve],
            "curve": [index for index, curve in enumerate(curves) for _ in curve],
            "series": [
                look[0 if index < len(curves) - 1 else 1].name
                for index, curve in enumerate(curves)
                for _ in curve
            ],
            "success": [percent(share, 1) for curve in curves for share in curve],
        }
    )
    layer = [
        alt.Chart(lines)
        .mark_line(strokeWidth=1.6)
        .encode(
            x_of("x", x_title, axis=alt.Axis(tickCount=4, grid=False)),
            y,
            detail="curve:N",
            opacity=seen(),
            **styles(look, "color", "strokeDash"),
        )
    ]
    if found["groups"]:
        paper = frame(
            {
                "x": [group["low_mm"] for group in found["groups"]],
                "x2": [group["high_mm"] for group in found["groups"]],
                "y": [group["paper"] for group in found["groups"]],
                "series": [look[2].name] * len(found["groups"]),
            }
        )
        layer.append(
            alt.Chart(paper)
            .mark_rule(strokeWidth=2)
            .encode(
                alt.X("x:Q"),
                alt.Y("y:Q"),
                x2="x2:Q",
                opacity=seen(),
                **styles(look, "color", "strokeDash"),
            )
        )
    return layers(*layer, height=HEIGHT_PX, title=textwrap.wrap(title, LABEL_CHARACTERS))
