"""Figure 6: Hellinger distances between variants, and their dendrogram with groups and cut."""

from __future__ import annotations

from collections.abc import Sequence

import altair as alt

from surmount.analysis.cut import may_divide
from surmount.analysis.result import Analysis
from surmount.report.document.parts import Columns, Figure
from surmount.report.document.text import number
from surmount.report.figures.charts import figure, frame, layers, seen, styles, words, x_of, y_of
from surmount.report.figures.dendrogram_layout import DendrogramLayout, layout
from surmount.report.figures.palette import ABOVE, INK, Series
from surmount.report.figures.variant_matrix import (
    group_styles,
    matrix_panel,
    variant_names,
    variant_title,
)

LEAF_PX = 14
LEAST_PX = 340
HEIGHT_TITLE = "Hellinger distance at which variants join"
LOOSE = Series(name="above the groups", colour=ABOVE, dash=(1, 0))


def distances_and_groups(analysis: Analysis) -> Figure:
    """Draw the distance matrix and the dendrogram (paper fig. 6)."""
    drawn = layout(analysis)
    n = analysis.variants.shape[0]
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
        chart=figure(
            [
                _distance_panel(analysis, [*group_styles(analysis), LOOSE]),
                _tree_panel(analysis, drawn),
            ],
            columns=2,
            least_px=LEAST_PX,
        ),
        data=_data(analysis),
    )


def distance_chart(analysis: Analysis) -> alt.ConcatChart:
    """Draw the distances alone."""
    return figure([_distance_panel(analysis)], columns=1, least_px=LEAST_PX, width_px=480)


def dendrogram_chart(analysis: Analysis) -> alt.ConcatChart:
    """Draw the dendrogram alone."""
    panel = _tree_panel(analysis, layout(analysis))
    return figure([panel], columns=1, least_px=LEAST_PX, width_px=560)


def _caption(analysis: Analysis, drawn: DendrogramLayout) -> tuple[str, ...]:
    config, cut = analysis.config, analysis.cut
    rule = f"Linkage: {config.linkage}; rule of the cut: {cut.method}"
    if cut.cut_off:
        rule += f", cut-off {cut.cut_off:g}"
    sentences = [
        (
            "Distances are unscented Hellinger distances between the variants' mixtures (eq. 1): 0 "
            "where behaviour is alike, 1 where nothing is shared. Frames mark the groups."
        ),
        f"{rule}.",
    ]
    if len(analysis.groups) == 1 and not may_divide(cut):
        sentences.append("So few variants cannot be cut: they form one group.")
    elif not drawn.cut.any():
        sentences.append("No link is abrupt enough to divide: all variants form one group.")
    if analysis.merges:
        small = [
            f"{', '.join(analysis.label(i) for i in merge.members)} (joins at {merge.height:.2f})"
            for merge in analysis.merges
        ]
        sentences.append(
            f"Groups of at most {analysis.merges[0].limit} variants were merged into their "
            f"neighbour: {'; '.join(small)}."
        )
    return tuple(sentences)


def _height(analysis: Analysis) -> int:
    return max(300, LEAF_PX * analysis.variants.shape[0])


def _distance_panel(analysis: Analysis, series: Sequence[Series] = ()) -> alt.LayerChart:
    return matrix_panel(
        analysis,
        analysis.distances,
        "distance {:.3f}".format,
        height=_height(analysis),
        title="Distances between variants: light is alike (0), dark is far (1)",
        series=series,
    )


def _tree_panel(analysis: Analysis, drawn: DendrogramLayout) -> alt.LayerChart:
    names = variant_names(analysis)
    labels = [names[leaf] for leaf in drawn.leaves]
    series = [*group_styles(analysis), LOOSE]
    of_link = [series[group].name for group in drawn.group]  # −1, above all groups, is the last
    top = 1.06 * float(drawn.heights[:, 2].max() or 1.0)
    x = x_of("x", HEIGHT_TITLE, domain=(0, top))
    y = y_of("y", variant_title(analysis), domain=(-0.6, len(labels) - 0.4), reverse=True,
             axis=alt.Axis(labels=False, ticks=False, grid=False, titlePadding=44))  # fmt: skip
    corners = {"x": [], "y": [], "link": [], "corner": [], "series": []}
    for link, (left, right, height) in enumerate(drawn.heights.tolist()):
        first, second = drawn.positions[link].tolist()
        corners["x"] += [left, height, height, right]
        corners["y"] += [first, first, second, second]
        corners["link"] += [link] * 4
        corners["corner"] += range(4)
        corners["series"] += [of_link[link]] * 4
    tree = (
        alt.Chart(frame(corners))
        .mark_line()
        .encode(
            x,
            y,
            detail="link:N",
            order="corner:Q",
            opacity=seen(),
            **styles(series, "color", "strokeDash"),
        )
    )
    layer = [tree, *_links(analysis, drawn, of_link, series)]
    if drawn.cut_height is not None:
        cut = alt.Chart(frame({"x": [drawn.cut_height], "told": ["the groups are cut here"]}))
        layer.append(
            cut.mark_rule(color=INK, strokeDash=[5, 4]).encode(
                x, tooltip=alt.Tooltip("told:N", title="cut")
            )
        )
    layer.append(
        words(
            {"y": list(range(len(labels))), "text": labels},
            x=alt.value(-6),
            align="right",
            baseline="middle",
            size=10,
        )
    )
    title = "Dendrogram: the rule divides at diamonds"
    if drawn.cut_height is not None:
        title += ", the dashed line is the cut"
    return layers(*layer, height=_height(analysis), title=title)


def _links(
    analysis: Analysis, drawn: DendrogramLayout, of_link: list[str], series: list[Series]
) -> list[alt.Chart]:
    """Return points on the links that tell their numbers; those that divide are diamonds."""
    links = range(drawn.group.size)
    points = frame(
        {
            "x": drawn.heights[:, 2],
            "y": drawn.positions.mean(axis=1),
            "series": of_link,
            "divides": ["yes" if cut else "no" for cut in drawn.divided],
            "joins": [
                f"{int(analysis.linkage[link, 3])} variants at {drawn.heights[link, 2]:.3f}"
                for link in links
            ],
            "rule": [
                f"{analysis.cut.method} {number(float(analysis.cut.statistic[link]))}"
                + (f", cut-off {analysis.cut.cut_off:g}" if analysis.cut.cut_off else "")
                for link in links
            ],
            "inconsistency": [
                f"{analysis.inconsistency[link]:.2f}, over depth 2 "
                f"{analysis.inconsistency_depth_2[link]:.2f}"
                for link in links
            ],
        }
    )
    base = alt.Chart(points).encode(
        x_of("x", HEIGHT_TITLE),
        y_of("y", None),
        tooltip=[f"{name}:N" for name in ("joins", "rule", "inconsistency", "divides")],
    )
    plain = base.transform_filter("datum.divides == 'no'").mark_point(filled=True, size=24)
    sharp = base.transform_filter("datum.divides == 'yes'").mark_point(
        filled=True, size=90, shape="diamond", color=INK
    )
    return [
        plain.encode(opacity=seen(), **styles(series, "color")),
        sharp,
    ]


def _data(analysis: Analysis) -> Columns:
    """Return one row per pair of variants and one per link of the dendrogram."""
    n = analysis.variants.shape[0]
    labels = analysis.labels_of_variants
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
