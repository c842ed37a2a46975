"""A curriculum as a chart: the success of its groups, and the weights of its levels."""

from __future__ import annotations

import altair as alt

from surmount.report.document.text import percent, short, variant_range
from surmount.report.figures.charts import figure, frame, layers, seen, styles
from surmount.report.figures.palette import INK, Series, group_series
from surmount.tasks.curriculum import Curriculum

ROW_PX = 36
LEAST_PX = 300


def curriculum_chart(curriculum: Curriculum) -> alt.ConcatChart:
    """Draw groups with their success in the trials, and what each level draws of them."""
    look = [group_series(i, short(group.name)) for i, group in enumerate(curriculum.groups)]
    panels = [_groups(curriculum, look)]
    if curriculum.levels:
        panels.append(_levels(curriculum, look))
    return figure(panels, columns=2, least_px=LEAST_PX, width_px=420 * len(panels))


def _groups(curriculum: Curriculum, look: list[Series]) -> alt.LayerChart:
    rows = frame(
        {
            "series": [one.name for one in look],
            "x": [group.success_rate for group in curriculum.groups],
            "success": [percent(group.success_rate) for group in curriculum.groups],
            "variants": [
                variant_range(curriculum.parameters, group.variants, curriculum.axes)
                for group in curriculum.groups
            ],
        }
    )
    base = alt.Chart(rows).encode(
        alt.Y("series:N", sort=None, title=None, axis=alt.Axis(ticks=False)),
        tooltip=[alt.Tooltip("series:N", title="group"), "variants:N", "success:N"],
    )
    bars = base.mark_bar(height=22).encode(
        alt.X(
            "x:Q",
            title="success in the logged trials",
            scale=alt.Scale(domain=[0, 1]),
            axis=alt.Axis(format=".0%"),
        ),
        opacity=seen(0.85),
        **styles(look, "color"),
    )
    threshold = (
        alt.Chart(
            frame({"x": [curriculum.success_threshold], "told": ["no level is needed above"]})
        )
        .mark_rule(color=INK, strokeDash=[5, 4])
        .encode(alt.X("x:Q"), tooltip=alt.Tooltip("told:N", title="threshold"))
    )
    return layers(
        bars, threshold, height=ROW_PX * len(look), title="Groups, from easy to difficult"
    )


def _levels(curriculum: Curriculum, look: list[Series]) -> alt.LayerChart:
    cells = [
        (f"level {number}", index, look[index].name, weight)
        for number, level in enumerate(curriculum.levels, start=1)
        for index, weight in enumerate(level.weights)
    ]
    rows = frame(
        {
            "level": [level for level, _, _, _ in cells],
            "order": [index for _, index, _, _ in cells],
            "series": [name for _, _, name, _ in cells],
            "x": [weight for _, _, _, weight in cells],
            "weight": [percent(weight) for _, _, _, weight in cells],
        }
    )
    bars = (
        alt.Chart(rows)
        .mark_bar(height=22)
        .encode(
            alt.X(
                "x:Q",
                title="share of the tasks drawn",
                scale=alt.Scale(domain=[0, 1]),
                axis=alt.Axis(format=".0%"),
            ),
            alt.Y("level:N", sort=None, title=None, axis=alt.Axis(ticks=False)),
            order="order:Q",
            opacity=seen(0.85),
            tooltip=["level:N", alt.Tooltip("series:N", title="group"), "weight:N"],
            **styles(look, "color"),
        )
    )
    return layers(bars, height=ROW_PX * len(curriculum.levels), title="Levels, in their order")
