"""Figure 5: recorded features beside features drawn from the mixture, and the BIC curve."""

from __future__ import annotations

import itertools

import numpy as np
import plotly.graph_objects as go
from matplotlib.axes import Axes
from matplotlib.figure import Figure as StillFigure
from matplotlib.ticker import MaxNLocator

from surmount.analysis.component_count import BICCurve
from surmount.analysis.explanation import describe_bic_choice
from surmount.analysis.result import Analysis
from surmount.core.arrays import FloatArray
from surmount.report.document.parts import Columns, Figure, LegendEntry, Panel
from surmount.report.document.text import axis_label, name_and_unit
from surmount.report.figures.palette import INK, PAPER
from surmount.report.figures.plots import annotate, compact, plain, plot
from surmount.report.figures.stills import axes_grid

RECORDED = "#444444"
SAMPLED = "#0072B2"
BINS = 40
MOST_FEATURES = 4
"""Pairs are drawn of so many features: six panels, as in the paper."""


def mixture_fit(analysis: Analysis) -> Figure:
    """Draw all pairs of features of the variant on which K was chosen (paper fig. 5)."""
    names = analysis.features.names[:MOST_FEATURES]
    pairs = list(itertools.combinations(range(len(names)), 2))
    chosen = analysis.mixtures[analysis.bic_variant].n_components
    where = _variant(analysis)
    panels = [_scatter_panel(analysis, first, second) for first, second in pairs]
    if not pairs:
        panels.append(_histogram_panel(analysis))
    if analysis.bic is not None:
        panels.append(_bic_panel(analysis.bic))
    caption = [
        (
            f"Recorded control steps of variant {where} and as many points drawn from its mixture "
            f"of {chosen} Gaussians: the closer the clouds, the better the mixture describes how "
            "it is done there."
        )
    ]
    if analysis.bic is not None:
        caption.append(_bic_sentence(analysis.bic))
        caption.append(f"K was chosen on {where}, {describe_bic_choice(analysis)}.")
    if len(analysis.features.names) > len(names):
        caption.append(
            f"Shown are the first {len(names)} of {len(analysis.features.names)} features."
        )
    return Figure(
        name="figure-5-mixture-fit",
        label="Figure 5",
        title="Recorded and sampled behaviour, and the choice of the number of Gaussians",
        caption=tuple(caption),
        alternative=(
            f"Points over pairs of the features {', '.join(map(axis_label, names))} for "
            f"variant {where}, recorded points beside points sampled from the mixture"
            + (", and the BIC over the number of components." if analysis.bic else ".")
        ),
        legend=(
            LegendEntry(text="recorded", colour=RECORDED, shape="circle"),
            LegendEntry(text="drawn from the mixture", colour=SAMPLED, shape="cross"),
        ),
        panels=tuple(panels),
        panel_width_px=270,
        still=lambda: _still(analysis, pairs),
        data=_data(analysis),
    )


def _variant(analysis: Analysis) -> str:
    unit = name_and_unit(analysis.parameters[0])[1] if len(analysis.parameters) == 1 else ""
    return f"{analysis.label(analysis.bic_variant)} {unit}".strip()


def _bic_sentence(curve: BICCurve) -> str:
    taken = f"K = {curve.chosen} was taken"
    if curve.chosen == curve.minimum:
        return f"{taken}, the minimum of the BIC (eq. 3)."
    return (
        f"{taken}: the smallest K whose BIC (eq. 3) lies within {curve.plateau:.0%} of the "
        f"curve's fall above its minimum at K = {curve.minimum}."
    )


def _scatter_panel(analysis: Analysis, first: int, second: int) -> Panel:
    names = analysis.features.names
    figure = plot(x_title=axis_label(names[first]), y_title=axis_label(names[second]))
    for points, colour, symbol, size in (
        (analysis.recorded, RECORDED, "circle", 4),
        (analysis.sampled, SAMPLED, "x-thin-open", 5),
    ):
        figure.add_trace(
            go.Scatter(
                x=compact(points[:, first]),
                y=compact(points[:, second]),
                mode="markers",
                marker={
                    "color": colour,
                    "symbol": symbol,
                    "size": size,
                    "opacity": 0.45,
                    "line": {"color": colour, "width": 1 if "thin" in symbol else 0},
                },
                hoverinfo="skip",
            )
        )
    return Panel(plot=figure, height_px=250)


def _histograms(analysis: Analysis) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return edges of bins, and the shares of recorded and sampled values of the one feature."""
    both = (analysis.recorded[:, 0], analysis.sampled[:, 0])
    edges = np.histogram_bin_edges(np.concatenate(both), bins=BINS)
    recorded, sampled = (np.histogram(values, edges)[0] / values.size for values in both)
    return edges, recorded, sampled


def _histogram_panel(analysis: Analysis) -> Panel:
    edges, *shares = _histograms(analysis)
    figure = plot(x_title=axis_label(analysis.features.names[0]), y_title="share")
    for values, colour in zip(shares, (RECORDED, SAMPLED), strict=True):
        figure.add_trace(
            go.Scatter(
                x=edges,
                y=[*values.tolist(), 0.0],
                mode="lines",
                line={"color": colour, "width": 2, "shape": "hv"},
                hoverinfo="skip",
            )
        )
    return Panel(plot=figure, height_px=250)


def _bic_panel(curve: BICCurve) -> Panel:
    figure = plot(x_title="components K", y_title="BIC, thousands")
    values = [value / 1000 for value in curve.values]
    figure.add_trace(
        go.Scatter(
            x=curve.components,
            y=values,
            mode="lines+markers",
            line={"color": INK, "width": 1.5},
            marker={
                "size": 7,
                "color": [INK if done else PAPER for done in curve.converged],
                "line": {"color": INK, "width": 1.5},
            },
            hovertext=[
                plain(f"K = {count}: BIC {value:,.0f}" + ("" if done else ", not converged"))
                for count, value, done in zip(
                    curve.components, curve.values, curve.converged, strict=True
                )
            ],
            hoverinfo="text",
        )
    )
    height = values[curve.components.index(curve.chosen)]
    figure.add_trace(
        go.Scatter(
            x=[curve.chosen],
            y=[height],
            mode="markers",
            marker={"size": 15, "color": SAMPLED, "symbol": "circle-open", "line": {"width": 2.5}},
            hoverinfo="skip",
        )
    )
    figure.add_vline(x=curve.chosen, line={"color": SAMPLED, "width": 1, "dash": "dot"})
    annotate(
        figure,
        f"K = {curve.chosen} taken",
        x=curve.chosen,
        y=1.0,
        yref="paper",
        yanchor="top",
        xanchor="right" if _right_of_middle(curve) else "left",
        xshift=-4 if _right_of_middle(curve) else 4,
    )
    return Panel(plot=figure, height_px=250)


def _right_of_middle(curve: BICCurve) -> bool:
    """Return whether the chosen K stands right of the middle, so that its label fits left of it."""
    return 2 * curve.chosen > curve.components[0] + curve.components[-1]


def _still(analysis: Analysis, pairs: list[tuple[int, int]]) -> StillFigure:
    count = max(len(pairs), 1) + (analysis.bic is not None)
    columns = min(3, count)
    rows = -(-count // columns)
    figure, axes = axes_grid(rows, columns, height_in=1.95 * rows + 0.25, used=count)
    for (first, second), ax in zip(pairs, axes, strict=False):
        _draw_pair(ax, analysis, first, second)
    if not pairs:
        _draw_histograms(axes[0], analysis)
    if analysis.bic is not None:
        _draw_bic(axes[-1], analysis.bic)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=2, markerscale=2.0)
    return figure


def _draw_pair(ax: Axes, analysis: Analysis, first: int, second: int) -> None:
    names = analysis.features.names
    clouds: tuple[tuple[FloatArray, str, str, str], ...] = (
        (analysis.recorded, RECORDED, ".", "recorded"),
        (analysis.sampled, SAMPLED, "x", "drawn from the mixture"),
    )
    for points, colour, marker, label in clouds:
        ax.scatter(
            points[:, first],
            points[:, second],
            s=6,
            c=colour,
            marker=marker,
            alpha=0.45,
            linewidths=0.5,
            label=label,
            rasterized=True,
        )
    ax.set_xlabel(axis_label(names[first]))
    ax.set_ylabel(axis_label(names[second]))


def _draw_histograms(ax: Axes, analysis: Analysis) -> None:
    edges, recorded, sampled = _histograms(analysis)
    ax.stairs(recorded, edges, color=RECORDED, label="recorded")
    ax.stairs(sampled, edges, color=SAMPLED, label="drawn from the mixture")
    ax.set_xlabel(axis_label(analysis.features.names[0]))
    ax.set_ylabel("share")


def _draw_bic(ax: Axes, curve: BICCurve) -> None:
    values = [value / 1000 for value in curve.values]
    ax.plot(curve.components, values, color=INK)
    for count, value, done in zip(curve.components, values, curve.converged, strict=True):
        ax.plot(count, value, "o", ms=3.5, mec=INK, mfc=INK if done else PAPER)
    height = values[curve.components.index(curve.chosen)]
    ax.plot(curve.chosen, height, "o", ms=8, mfc="none", mec=SAMPLED, mew=1.5)
    ax.axvline(curve.chosen, color=SAMPLED, lw=0.8, ls=":")
    left = _right_of_middle(curve)
    ax.annotate(
        f"K = {curve.chosen} taken",
        (curve.chosen, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(-3 if left else 3, -2),
        textcoords="offset points",
        ha="right" if left else "left",
        va="top",
        fontsize=7,
    )
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_xlabel("components K")
    ax.set_ylabel("BIC, thousands")


def _data(analysis: Analysis) -> Columns:
    rows = analysis.recorded.shape[0]
    curve = analysis.bic
    curve_rows = 0 if curve is None else len(curve.components)
    blank = [None] * curve_rows
    columns: dict[str, list[object]] = {
        "kind": ["recorded"] * rows + ["sampled"] * len(analysis.sampled) + ["bic"] * curve_rows
    }
    for index, name in enumerate(analysis.features.names):
        values = [*analysis.recorded[:, index].tolist(), *analysis.sampled[:, index].tolist()]
        columns[name] = [*values, *blank]
    others: list[object] = [None] * (rows + len(analysis.sampled))
    columns["components"] = [*others, *(curve.components if curve else ())]
    columns["bic"] = [*others, *(curve.values if curve else ())]
    columns["converged"] = [*others, *(curve.converged if curve else ())]
    return columns
