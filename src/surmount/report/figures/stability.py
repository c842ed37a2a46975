"""Figure: success on each variant, and how surely the variants belong together."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
from matplotlib.axes import Axes
from matplotlib.figure import Figure as StillFigure

from surmount.analysis.result import Analysis
from surmount.analysis.stability import Stability
from surmount.report.document.parts import Columns, Figure, LegendEntry, Panel
from surmount.report.document.text import percent, short
from surmount.report.figures.palette import INK, MUTED, group_colour
from surmount.report.figures.plots import compact, hover, plain, plot
from surmount.report.figures.stills import axes_grid
from surmount.report.figures.variant_matrix import (
    draw_matrix,
    matrix_panel,
    ticks_of,
    variant_title,
)
from surmount.stats.proportions import ProportionIntervals, proportion_intervals

HEIGHT_PX = 330


def success_and_stability(analysis: Analysis) -> Figure | None:
    """Draw success by variant and the bootstrap's co-memberships; ``None`` without a bootstrap."""
    stability = analysis.stability
    if stability is None:
        return None
    boundaries = analysis.in_a_row
    panels = (
        Panel(
            plot=_success_panel(analysis, stability),
            height_px=HEIGHT_PX,
            title="Success, and boundaries" if boundaries else "Success",
        ),
        Panel(
            plot=matrix_panel(analysis, stability.co_membership, _together, likeness=True),
            height_px=HEIGHT_PX,
            title="Variants in one group",
        ),
    )
    caption = [
        (
            "Success of the trials on each variant, with Wilson's 95 % intervals, and for every "
            f"two variants the share of {stability.replicates} bootstrap replicates in which they "
            "were in one group: light within the frames and dark outside where the grouping is "
            "sure."
        )
    ]
    if boundaries:
        caption.append(
            "Bars stand between neighbouring variants: the share of replicates with a boundary."
        )
    return Figure(
        name="success-and-stability",
        label="",
        title="How success lies over the variants, and how sure their groups are",
        caption=tuple(caption),
        alternative=(
            "Success rates of all variants with intervals, and a heat map of how often two "
            "variants were in one group when networks and trials were drawn again."
        ),
        legend=(
            *(
                LegendEntry(text=group.name, colour=group_colour(index), shape="circle")
                for index, group in enumerate(analysis.groups)
            ),
            *(
                [LegendEntry(text="boundary in replicates", colour=MUTED, shape="square")]
                if boundaries
                else []
            ),
        ),
        panels=panels,
        panel_width_px=340,
        still=lambda: _still(analysis, stability),
        data=_data(analysis, stability),
    )


def _together(share: float) -> str:
    return f"in one group in {percent(share)} of the replicates"


def _share(analysis: Analysis) -> str:
    return f"share of trials{' or replicates' if analysis.in_a_row else ''}"


def _limits(analysis: Analysis) -> ProportionIntervals:
    return proportion_intervals(analysis.trials_won, analysis.n_trials)


def _success_panel(analysis: Analysis, stability: Stability) -> go.Figure:
    figure = plot(x_title=variant_title(analysis), y_title=_share(analysis))
    labels = analysis.labels_of_variants
    if analysis.in_a_row:
        figure.add_trace(
            go.Bar(
                x=np.arange(len(labels) - 1) + 0.5,
                y=compact(stability.boundaries),
                width=0.35,
                marker={"color": MUTED, "opacity": 0.45},
                hovertext=[
                    hover(
                        f"between {labels[i]} and {labels[i + 1]}",
                        f"a boundary in {percent(float(share))} of the replicates",
                    )
                    for i, share in enumerate(stability.boundaries)
                ],
                hoverinfo="text",
            )
        )
    limits = _limits(analysis)
    for index in range(len(analysis.groups)):
        own = np.flatnonzero(analysis.labels == index)
        rates = analysis.success_rate[own]
        lower, upper = (np.asarray(side)[own] for side in (limits.lower, limits.upper))
        figure.add_trace(
            go.Scatter(
                x=own,
                y=compact(rates),
                mode="markers",
                marker={"color": group_colour(index), "size": 8},
                error_y={
                    "type": "data",
                    "symmetric": False,
                    "array": upper - rates,
                    "arrayminus": rates - lower,
                    "thickness": 1.2,
                    "width": 0,
                },
                hovertext=[
                    hover(
                        f"{labels[i]} ({analysis.groups[index].name})",
                        f"success {percent(float(analysis.success_rate[i]))} of "
                        f"{analysis.n_trials[i]} trials",
                    )
                    for i in own
                ],
                hoverinfo="text",
            )
        )
    ticks = ticks_of(len(labels))
    figure.update_xaxes(tickvals=ticks, ticktext=[plain(labels[i]) for i in ticks], showgrid=False)
    figure.update_yaxes(range=[-0.03, 1.03], tickformat=".0%")
    return figure


def _still(analysis: Analysis, stability: Stability) -> StillFigure:
    figure, (success, matrix) = axes_grid(1, 2, height_in=3.2)
    _draw_success(success, analysis, stability)
    draw_matrix(
        figure,
        matrix,
        analysis,
        stability.co_membership,
        "share of replicates in one group",
        likeness=True,
    )
    return figure


def _draw_success(ax: Axes, analysis: Analysis, stability: Stability) -> None:
    if analysis.in_a_row:
        places = np.arange(stability.boundaries.size) + 0.5
        ax.bar(places, stability.boundaries, width=0.35, color=MUTED, alpha=0.45, label="boundary")
    limits = _limits(analysis)
    for index, group in enumerate(analysis.groups):
        own = np.flatnonzero(analysis.labels == index)
        rates = analysis.success_rate[own]
        lower, upper = (np.asarray(side)[own] for side in (limits.lower, limits.upper))
        ax.errorbar(
            own,
            rates,
            yerr=np.maximum([rates - lower, upper - rates], 0.0),
            fmt="o",
            ms=4,
            lw=0.9,
            color=group_colour(index),
            label=short(group.name),
        )
    ticks = ticks_of(analysis.variants.shape[0])
    labels = [analysis.label(i) for i in ticks]
    ax.set_xticks(ticks, labels, rotation=0 if len(analysis.parameters) == 1 else 90)
    ax.set_ylim(-0.03, 1.03)
    ax.set_xlabel(variant_title(analysis))
    ax.set_ylabel(_share(analysis), color=INK)
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.2)


def _data(analysis: Analysis, stability: Stability) -> Columns:
    """Return one row per variant, then one per pair of variants."""
    n = analysis.variants.shape[0]
    labels = analysis.labels_of_variants
    limits = _limits(analysis)
    pairs = [(i, j) for i in range(n) for j in range(n)]
    none, empty = [None] * (n * n), [None] * n
    return {
        "kind": ["variant"] * n + ["pair"] * (n * n),
        "first": [*labels, *(labels[i] for i, _ in pairs)],
        "second": [*empty, *(labels[j] for _, j in pairs)],
        "group": [*(analysis.groups[group].name for group in analysis.labels), *none],
        "trials": [*analysis.n_trials.tolist(), *none],
        "success": [*analysis.success_rate.tolist(), *none],
        "lower": [*limits.lower, *none],
        "upper": [*limits.upper, *none],
        "boundary_after": [*stability.boundaries.tolist(), None, *none],
        "together": [*empty, *stability.co_membership.ravel().tolist()],
    }
