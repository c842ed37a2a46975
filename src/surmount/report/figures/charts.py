"""Charts in one style: what all figures have in common, from the frame of rows to the panels.

A figure is one Altair chart. The page draws it with Vega and shows it as a picture until then;
Markdown, files and print have the picture; a notebook shows the chart itself.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import altair as alt
import numpy as np
import polars as pl

from surmount.report.document.text import short
from surmount.report.figures.palette import GRID, INK, MUTED, PAPER, Series

FONT = "Arial, Helvetica, 'Liberation Sans', sans-serif"
WIDTH_PX = 880
"""Width of a figure as a picture."""
AXIS_PX = 64
"""What axis labels take of a panel's width."""
ASIDE = 0.08
"""Opacity of what the legend has switched off."""
EDGE_PX = 6
DIGITS = 5
"""Significant digits of drawn numbers: finer than any screen."""
MOST_ROWS = 5000
"""Rows of a frame that Altair passes on."""

Zoomed = "wheel![event.ctrlKey || event.metaKey]"
"""The wheel alone scrolls the page."""


def frame(columns: Mapping[str, Sequence[object] | np.ndarray]) -> pl.DataFrame | alt.InlineData:
    """Return rows to draw; an undefined number is a null, which no mark shows."""
    table = pl.DataFrame({name: _column(values) for name, values in columns.items()})
    if table.height <= MOST_ROWS:
        return table
    return alt.InlineData(values=table.to_dicts())


def _column(values: Sequence[object] | np.ndarray) -> pl.Series:
    series = pl.Series(values, strict=False)
    if series.dtype.is_float():
        return series.fill_nan(None).round_sig_figs(DIGITS)
    return series


def styles(
    series: Sequence[Series], *channels: str, legend: bool = True, field: str = "series"
) -> dict[str, Any]:
    """Return encodings of a column by colour, dash or shape, as one legend.

    Parameters
    ----------
    series
        What there is, in the order of the legend.
    channels
        Of ``"color"``, ``"strokeDash"`` and ``"shape"``; those of all layers of a figure must be
        the same for their legends to be one.
    legend
        Whether they are told; else they only agree with those that are.
    field
        The column.
    """
    names = [one.name for one in series]
    ranges: dict[str, list[Any]] = {
        "color": [one.colour for one in series],
        "stroke": [one.colour for one in series],
        "fill": [one.colour for one in series],
        "strokeDash": [list(one.dash) for one in series],
        "shape": [one.shape for one in series],
    }
    told = alt.Legend(title=None, labelLimit=240) if legend else None
    kinds = {
        "color": alt.Color,
        "stroke": alt.Stroke,
        "fill": alt.Fill,
        "strokeDash": alt.StrokeDash,
        "shape": alt.Shape,
    }
    return {
        channel: kinds[channel](
            f"{field}:N",
            title=None,
            scale=alt.Scale(domain=names, range=ranges[channel]),
            legend=told,
        )
        for channel in channels
    }


def seen(opacity: float = 1.0) -> Any:
    """Return the opacity of what the legend has not switched off."""
    shown = alt.selection_point(name="shown", fields=["series"])
    return alt.when(shown).then(alt.value(opacity)).otherwise(alt.value(min(ASIDE, opacity)))


def x_of(field: str, title: str | None, **options: Any) -> alt.X:
    """Return a quantitative horizontal axis; the title is taken as plain text."""
    return alt.X(f"{field}:Q", title=title, **_axis(options))


def y_of(field: str, title: str | None, **options: Any) -> alt.Y:
    """Return a quantitative vertical axis; the title is taken as plain text."""
    return alt.Y(f"{field}:Q", title=title, **_axis(options))


def shares(title: str, field: str = "y", top: float = 1.0, bottom: float = 0.0) -> alt.Y:
    """Return a vertical axis of shares from 0 to 100 %, with room above for what is written."""
    return y_of(
        field,
        title,
        domain=(bottom, top),
        axis=alt.Axis(format=".0%", values=[0, 0.25, 0.5, 0.75, 1]),
    )


def _axis(options: dict[str, Any]) -> dict[str, Any]:
    found = dict(options)
    scale: dict[str, Any] = {"nice": False, "zero": found.pop("zero", False)}
    if (domain := found.pop("domain", None)) is None:
        scale["padding"] = EDGE_PX  # so that no mark lies half outside
    else:
        scale["domain"] = [float(end) for end in domain]
    if found.pop("reverse", False):
        scale["reverse"] = True
    return {"scale": alt.Scale(**scale), **found}


def words(rows: Mapping[str, Sequence[object]], *, size: float = 11, **options: Any) -> alt.Chart:
    """Write the column ``text`` at ``x`` and ``y`` of the axes; both may be encodings instead."""
    x, y = (options.pop(axis, alt.X(f"{axis}:Q") if axis == "x" else alt.Y(f"{axis}:Q"))
            for axis in ("x", "y"))  # fmt: skip
    return (
        alt.Chart(frame(rows))
        .mark_text(fontSize=size, color=INK, **options)
        .encode(x=x, y=y, text="text:N")
    )


def tick_labels(
    places: Sequence[float], labels: Sequence[str], height: int, *, upright: bool = False
) -> alt.Chart:
    """Write labels below a horizontal axis whose own numbers would say nothing."""
    turned: dict[str, Any] = {"angle": 270, "align": "right"} if upright else {"align": "center"}
    return words(
        {"x": places, "text": [short(label) for label in labels]},
        y=alt.value(height + (6 if upright else 8)),
        baseline="middle" if upright else "top",
        **turned,
    )


def layers(
    *charts: alt.Chart | alt.LayerChart, height: int, title: str | list[str] = "", note: str = ""
) -> alt.LayerChart:
    """Return one panel, with a heading and a note below it where they are given."""
    whole = alt.LayerChart(layer=list(charts), height=height)
    if not title:
        return whole
    heading = alt.TitleParams(title, subtitle=note) if note else title
    return whole.properties(title=heading)


def figure(
    panels: Sequence[alt.Chart | alt.LayerChart],
    *,
    columns: int,
    least_px: int,
    zoom: bool = False,
    pick: bool = True,
    width_px: int = WIDTH_PX,
) -> alt.ConcatChart:
    """Lay out the panels of a figure with one legend, and what a reader may do with them.

    Parameters
    ----------
    panels
        In reading order.
    columns
        Side by side, where there is room.
    least_px
        Least width of a panel before the page takes fewer columns.
    zoom
        Whether panels can be moved and zoomed, with the control key and the wheel.
    pick
        Whether the legend's entries can be picked by a click: marks have ``seen`` as opacity.
    width_px
        Of the whole figure.
    """
    columns = min(columns, len(panels))
    width = width_px // columns - AXIS_PX
    placed = [_named(panel, f"panel_{i}").properties(width=width) for i, panel in enumerate(panels)]
    if zoom:
        placed = [
            panel.add_params(
                alt.selection_interval(name=f"zoom_{index}", bind="scales", zoom=Zoomed)
            )
            for index, panel in enumerate(placed)
        ]
    with warnings.catch_warnings():  # that panels share one selection is meant
        warnings.filterwarnings("ignore", message="Automatically deduplicated")
        whole = alt.concat(*placed, columns=columns, spacing=18).resolve_scale(
            color="shared", stroke="shared", fill="shared", strokeDash="shared", shape="shared"
        )
        if pick:
            whole = whole.add_params(
                alt.selection_point(name="shown", fields=["series"], bind="legend")
            )
    return styled(whole).properties(
        usermeta={"columns": columns, "least_px": least_px, "axis_px": AXIS_PX, "zoom": zoom}
    )


def _named(panel: alt.Chart | alt.LayerChart, name: str) -> alt.Chart | alt.LayerChart:
    """Name the view that a selection is put on: names that Altair makes up can miss it."""
    if isinstance(panel, alt.LayerChart):
        first, *others = panel.layer
        whole = panel.copy(deep=False)
        whole.layer = [first.properties(name=name), *others]
        return whole
    return panel.properties(name=name)


def styled(chart: alt.ConcatChart) -> alt.ConcatChart:
    """Return a chart in the style of the page."""
    label: dict[str, Any] = {
        "labelColor": INK,
        "titleColor": INK,
        "labelFontSize": 11,
        "titleFontSize": 12,
    }
    return chart.configure(
        background=PAPER,
        font=FONT,
        aria=False,
        axis=alt.AxisConfig(
            **label,
            titleFontWeight="normal",
            gridColor=GRID,
            domainColor=INK,
            tickColor=INK,
            tickSize=4,
            labelLimit=140,
            labelOverlap=True,
        ),
        legend=alt.LegendConfig(
            symbolOpacity=1,
            orient="top",
            labelColor=INK,
            labelFontSize=12,
            symbolSize=110,
            symbolStrokeWidth=2.2,
            columnPadding=16,
        ),
        title=alt.TitleConfig(
            color=INK,
            fontSize=12,
            fontWeight="bold",
            anchor="start",
            frame="group",
            offset=6,
            subtitleColor=MUTED,
            subtitleFontSize=11,
        ),
        view=alt.ViewConfig(stroke=None),
        line=alt.LineConfig(strokeWidth=2, strokeCap="butt"),
    )
