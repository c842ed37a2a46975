"""Figure 6: Hellinger distances between variants, and their dendrogram with groups and cut."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
from matplotlib.axes import Axes
from matplotlib.figure import Figure as StillFigure

from surmount.analysis.cut import may_divide
from surmount.analysis.result import Analysis
from surmount.report.document.parts import Columns, Figure, LegendEntry, Panel
from surmount.report.document.text import number, percent, short, variant_label
from surmount.report.figures.dendrogram_layout import DendrogramLayout, layout
from surmount.report.figures.palette import INK, MUTED, PAPER, group_colour
from surmount.report.figures.plots import compact, hover, plain, plot
from surmount.report.figures.stills import axes_grid
from surmount.report.figures.variant_matrix import draw_matrix, matrix_panel, variant_title

ABOVE = "#555555"
"""Links above all groups."""
LEAF_PX = 15
HEIGHT_TITLE = "Hellinger distance at which variants join"


def distances_and_groups(analysis: Analysis) -> Figure:
    """Draw the distance matrix and the dendrogram (paper fig. 6)."""
    drawn = layout(analysis)
    n = analysis.variants.shape[0]
    height = max(330, LEAF_PX * n + 80)
    panels = [
        Panel(
            plot=matrix_panel(analysis, analysis.distances, "distance {:.3f}".format),
            height_px=height,
            title="Distances between variants",
        ),
        Panel(plot=_tree_panel(analysis, drawn), height_px=height, title="Dendrogram and groups"),
    ]
    names = [group.name for group in analysis.groups]
    return Figure(
        name="figure-6-distances-and-groups",
        label="Figure 6",
        title="Distances between the behaviours on all variants, and the groups they form",
        caption=_caption(analysis, drawn),
        alternative=(
            f"Heat map of the Hellinger distances between {n} variants, and a dendrogram of the "
            f"same variants in {len(names)} coloured groups: {', '.join(names)}."
        ),
        legend=(
            *(
                LegendEntry(text=name, colour=group_colour(index), shape="line")
                for index, name in enumerate(names)
            ),
            LegendEntry(text="above the groups", colour=ABOVE, shape="line"),
            LegendEntry(text="the rule divides here", colour=INK, shape="diamond"),
            *(
                [LegendEntry(text="cut", colour=INK, shape="dash")]
                if drawn.cut_height is not None
                else []
            ),
        ),
        panels=tuple(panels),
        panel_width_px=340,
        still=lambda: _still(analysis, drawn),
        data=_data(analysis),
    )


def _caption(analysis: Analysis, drawn: DendrogramLayout) -> tuple[str, ...]:
    config, cut = analysis.config, analysis.cut
    rule = f"Linkage: {config.linkage}; rule of the cut: {cut.method}"
    if cut.cut_off:
        rule += f", cut-off {cut.cut_off:g}"
    sentences = [
        (
            "Distances are unscented Hellinger distances between the variants' mixtures (eq. 1): 0 "
            "where the robot behaves alike, 1 where nothing is shared. Frames mark the groups."
        ),
        f"{rule}.",
    ]
    if len(analysis.groups) == 1 and not may_divide(cut):
        sentences.append("So few variants cannot be cut: they form one group.")
    elif not drawn.cut.any():
        sentences.append("No link is abrupt enough to divide: all variants form one group.")
    if analysis.merges:
        small = [
            f"{', '.join(variant_label(analysis.variants[i]) for i in merge.members)} (joins at "
            f"{merge.height:.2f})"
            for merge in analysis.merges
        ]
        sentences.append(
            f"Groups of at most {analysis.merges[0].limit} variants were merged into their "
            f"neighbour: {'; '.join(small)}."
        )
    return tuple(sentences)


def _tree_panel(analysis: Analysis, drawn: DendrogramLayout) -> go.Figure:
    figure = plot(x_title=HEIGHT_TITLE, y_title=variant_title(analysis))
    labels = [variant_label(analysis.variants[leaf]) for leaf in drawn.leaves]
    for group in [-1, *range(len(analysis.groups))]:
        x: list[float | None] = []
        y: list[float | None] = []
        for link in np.flatnonzero(drawn.group == group):
            left, right, top = drawn.heights[link].tolist()
            first, second = drawn.positions[link].tolist()
            x += [left, top, top, right, None]
            y += [first, first, second, second, None]
        if x:
            colour = ABOVE if group < 0 else group_colour(group)
            figure.add_trace(
                go.Scatter(
                    x=x, y=y, mode="lines", line={"color": colour, "width": 2}, hoverinfo="skip"
                )
            )
    _add_links(figure, analysis, drawn)
    if drawn.cut_height is not None:
        figure.add_vline(x=drawn.cut_height, line={"color": INK, "width": 1.2, "dash": "dash"})
    n = len(labels)
    figure.update_yaxes(
        tickvals=list(range(n)),
        ticktext=[plain(label) for label in labels],
        range=[n - 0.4, -0.6],
        showgrid=False,
        tickfont={"size": 11},
    )
    figure.update_xaxes(range=[0, 1.06 * float(drawn.heights[:, 2].max() or 1.0)])
    return figure


def _add_links(figure: go.Figure, analysis: Analysis, drawn: DendrogramLayout) -> None:
    """Add a point on every link that tells its numbers; those that divide are diamonds."""
    texts = [
        hover(
            f"{int(analysis.linkage[link, 3])} variants join at {drawn.heights[link, 2]:.3f}",
            f"{analysis.cut.method}: {number(float(analysis.cut.statistic[link]))}"
            + (f", cut-off {analysis.cut.cut_off:g}" if analysis.cut.cut_off else ""),
            f"inconsistency {analysis.inconsistency[link]:.2f}, over depth 2 "
            f"{analysis.inconsistency_depth_2[link]:.2f}",
            "divides" if drawn.divided[link] else "does not divide",
        )
        for link in range(drawn.group.size)
    ]
    figure.add_trace(
        go.Scatter(
            x=compact(drawn.heights[:, 2]),
            y=compact(drawn.positions.mean(axis=1)),
            mode="markers",
            marker={
                "symbol": ["diamond" if cut else "circle" for cut in drawn.divided],
                "size": [11 if cut else 5 for cut in drawn.divided],
                "color": [
                    INK if cut else (ABOVE if group < 0 else group_colour(int(group)))
                    for cut, group in zip(drawn.divided, drawn.group, strict=True)
                ],
                "line": {"color": PAPER, "width": 0.5},
            },
            hovertext=texts,
            hoverinfo="text",
        )
    )


def _still(analysis: Analysis, drawn: DendrogramLayout) -> StillFigure:
    n = analysis.variants.shape[0]
    figure, (matrix, tree) = axes_grid(1, 2, height_in=max(3.2, 0.115 * n + 0.9))
    draw_matrix(figure, matrix, analysis, analysis.distances, "Hellinger distance")
    _draw_tree(tree, analysis, drawn)
    return figure


def _draw_tree(ax: Axes, analysis: Analysis, drawn: DendrogramLayout) -> None:
    for link in range(drawn.group.size):
        left, right, top = drawn.heights[link]
        first, second = drawn.positions[link]
        group = int(drawn.group[link])
        colour = ABOVE if group < 0 else group_colour(group)
        ax.plot([left, top, top, right], [first, first, second, second], color=colour)
        if drawn.divided[link]:
            ax.plot(top, (first + second) / 2, "D", ms=5, color=INK, zorder=3)
    if drawn.cut_height is not None:
        ax.axvline(drawn.cut_height, color=INK, lw=0.9, ls="--")
    for index, group in enumerate(analysis.groups):
        colour = group_colour(index)
        ax.plot([], [], color=colour, label=f"{short(group.name)} ({percent(group.success_rate)})")
    # Above the axes, where no link runs beneath it.
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)
    labels = [variant_label(analysis.variants[leaf]) for leaf in drawn.leaves]
    ax.set_yticks(range(len(labels)), labels, fontsize=6.5)
    ax.set_ylim(len(labels) - 0.4, -0.6)
    ax.set_xlim(0, 1.06 * float(drawn.heights[:, 2].max() or 1.0))
    ax.set_xlabel(HEIGHT_TITLE)
    ax.set_ylabel(variant_title(analysis))
    ax.tick_params(axis="y", colors=MUTED)


def _data(analysis: Analysis) -> Columns:
    """Return one row per pair of variants and one per link of the dendrogram."""
    n = analysis.variants.shape[0]
    labels = [variant_label(variant) for variant in analysis.variants]
    names = [analysis.groups[group].name for group in analysis.labels]
    rows, links = [i for i in range(n) for _ in range(n)], range(n - 1)
    columns = [j for _ in range(n) for j in range(n)]
    pairs, none = [None] * (n * n), [None] * (n - 1)
    return {
        "kind": ["distance"] * (n * n) + ["link"] * (n - 1),
        "first": [*(labels[i] for i in rows), *(int(analysis.linkage[k, 0]) for k in links)],
        "second": [*(labels[j] for j in columns), *(int(analysis.linkage[k, 1]) for k in links)],
        "first_group": [*(names[i] for i in rows), *none],
        "second_group": [*(names[j] for j in columns), *none],
        "distance": [*analysis.distances.ravel().tolist(), *analysis.linkage[:, 2].tolist()],
        "variants_below": [*pairs, *(int(analysis.linkage[k, 3]) for k in links)],
        "cut_statistic": [*pairs, *analysis.cut.statistic.tolist()],
        "inconsistency": [*pairs, *analysis.inconsistency.tolist()],
        "divided": [*pairs, *analysis.cut.divided.tolist()],
    }
