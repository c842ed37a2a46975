"""The capability map as a figure: which sizes scripted manoeuvres overcome, for each physics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import altair as alt

from surmount.report.document.parts import Chart
from surmount.report.figures.charts import figure, frame, layers, seen, styles, y_of
from surmount.report.figures.palette import INK, MUTED, PAPER, Series
from surmount.report.figures.stills import draw, write_still

HARDEST_MM = {"narrow-channel": 180.0, "low-entrance": 55.0, "step": 50.0}
"""The paper's hardest variants (III-C)."""
FOUND = {
    False: Series(name="none found", colour=MUTED),
    True: Series(name="manoeuvre found", colour=INK),
}
"""Whether a size is overcome."""


def write_capability_figure(record: Mapping[str, Any], folder: Path) -> None:
    """Draw a capability map and write ``capability.svg``, ``.png`` and ``.csv``.

    Parameters
    ----------
    record
        The map, as :func:`surmount.studies.capability.map_capability` returns it.
    folder
        Where the files go.
    """
    files = draw(_draw(record))
    cells = [(column, cell) for column in record["columns"] for cell in column["cells"]]
    table = {
        **{
            name: [column[name] for column, _ in cells]
            for name in ("gear", "friction", "torque_factor")
        },
        **{name: [cell[name] for _, cell in cells] for name in ("size_mm", "feasible", "tried")},
    }
    write_still(folder, "capability", files, table)


def _draw(record: Mapping[str, Any]) -> Chart:
    columns = sorted(record["columns"], key=_order)
    hardest = HARDEST_MM[record["config"]["obstacle"]]
    gears = list(dict.fromkeys(column["gear"] for column in columns)) or [""]
    panels = [
        _panel(gear, [column for column in columns if column["gear"] == gear], hardest)
        for gear in gears
    ]
    return figure(panels, columns=len(panels), least_px=260)


def _panel(gear: str, columns: Sequence[Mapping[str, Any]], hardest: float) -> alt.LayerChart:
    cells = [(_tick(column), cell) for column in columns for cell in column["cells"]]
    scaled = any(column["torque_factor"] != 1 for column in columns)
    ticks = list(dict.fromkeys(tick for tick, _ in cells))
    line = alt.Chart(frame({"y": [hardest], "told": ["the paper's hardest variant"]}))
    layer = [
        line.mark_rule(color=MUTED, strokeDash=[5, 4]).encode(
            y_of("y", "size in mm"), tooltip=alt.Tooltip("told:N", title="dashed")
        )
    ]
    if cells:
        points = frame(
            {
                "x": [tick for tick, _ in cells],
                "y": [cell["size_mm"] for _, cell in cells],
                "series": [FOUND[cell["feasible"]].name for _, cell in cells],
                "size": [f"{cell['size_mm']:g} mm" for _, cell in cells],
            }
        )
        layer.append(
            alt.Chart(points)
            .mark_point(size=60, strokeWidth=1.4, shape="square")
            .encode(
                alt.X(
                    "x:N",
                    sort=None,
                    scale=alt.Scale(domain=ticks),
                    title="friction × factor on torques" if scaled else "friction",
                    axis=alt.Axis(labelAngle=270 if scaled else 0),
                ),
                y_of("y", "size in mm"),
                opacity=seen(),
                tooltip=["size:N", alt.Tooltip("series:N", title="here")],
                **styles([FOUND[True], FOUND[False]], "stroke"),
                fill=alt.Fill(
                    "series:N",
                    title=None,
                    legend=alt.Legend(title=None, labelLimit=240),
                    scale=alt.Scale(
                        domain=[FOUND[True].name, FOUND[False].name], range=[INK, PAPER]
                    ),
                ),
            )
        )
    return layers(*layer, height=280, title=gear)


def _order(column: Mapping[str, Any]) -> tuple[int, float, float]:
    plainest_first = ("wheels", "whegs", "both")
    return (
        plainest_first.index(column["gear"]),
        column["torque_factor"],
        column["friction"],
    )


def _tick(column: Mapping[str, Any]) -> str:
    factor = column["torque_factor"]
    return f"{column['friction']:g}" + ("" if factor == 1 else f" × {factor:g}")
