"""Figure 9: path lengths of sprawl and FBEM over successful trials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import altair as alt
import numpy as np

from surmount.core.arrays import FloatArray
from surmount.report.document.parts import Columns, Figure
from surmount.report.document.text import integer, name_and_unit, number, short
from surmount.report.figures.charts import (
    figure,
    frame,
    layers,
    seen,
    styles,
    tick_labels,
    words,
    x_of,
    y_of,
)
from surmount.report.figures.palette import ARM_STYLES
from surmount.report.outcomes import PATHS, Outcomes
from surmount.tasks.curriculum import Curriculum
from surmount.workflow.run_layout import ARMS

BOX_WIDTH = 0.3
HEIGHT_PX = 260
LEAST_PX = 300
WHISKER = 1.5
"""Whiskers reach to the outermost value within so many interquartile ranges of the box."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Box:
    """The five numbers of a box plot and what lies beyond (Tukey).

    Attributes
    ----------
    count
        Values in all.
    low, q1, median, q3, high
        End of the lower whisker, quartiles, end of the upper whisker.
    beyond
        Values outside the whiskers.
    """

    count: int
    low: float
    q1: float
    median: float
    q3: float
    high: float
    beyond: FloatArray


def box_of(values: FloatArray) -> Box:
    """Summarise at least one value."""
    q1, median, q3 = np.quantile(values, [0.25, 0.5, 0.75]).tolist()
    reach = WHISKER * (q3 - q1)
    inside = values[(values >= q1 - reach) & (values <= q3 + reach)]
    return Box(
        count=int(values.size),
        low=float(inside.min()),
        q1=q1,
        median=median,
        q3=q3,
        high=float(inside.max()),
        beyond=values[(values < q1 - reach) | (values > q3 + reach)],
    )


Boxes = Mapping[str, Mapping[str, list[Box | None]]]
"""By path and arm, one entry per group; ``None`` where no trial succeeded."""


def path_lengths(curriculum: Curriculum, tests: Mapping[str, Outcomes]) -> Figure | None:
    """Draw box plots per group and arm (paper fig. 9); ``None`` where no path was logged."""
    arms = [arm for arm in ARMS if arm in tests]
    paths = [path for path in PATHS if all(path in tests[arm].path_lengths for arm in arms)]
    if not arms or not paths:
        return None
    boxes: Boxes = {
        path: {arm: _boxes(tests[arm], curriculum, path) for arm in arms} for path in paths
    }
    names = [group.name for group in curriculum.groups]
    return Figure(
        name="figure-9-path-lengths",
        label="Figure 9",
        title="Path lengths of the joints over successful trials",
        caption=(
            (
                "Σ|Δ| of the angle over each successful test trial of all networks. Boxes: "
                f"quartiles; whiskers: to the outermost trial within {WHISKER:g} interquartile "
                "ranges; rings: trials beyond. A shorter path is a calmer motion."
            ),
        ),
        alternative="Box plots of path lengths, medians: "
        + "; ".join(
            f"{name_and_unit(path)[0]}, {name}, {arm} "
            + (f"{number(box.median)}°" if (box := boxes[path][arm][index]) else "none")
            for path in paths
            for index, name in enumerate(names)
            for arm in arms
        )
        + ".",
        chart=figure(
            [_panel(path, boxes[path], names) for path in paths], columns=2, least_px=LEAST_PX
        ),
        data=_data(curriculum, tests, arms, paths),
    )


def _boxes(outcomes: Outcomes, curriculum: Curriculum, path: str) -> list[Box | None]:
    groups, lengths = curriculum.groups_of(outcomes.variant), outcomes.path_lengths[path]
    found: list[Box | None] = []
    for group in range(len(curriculum.groups)):
        values = lengths[outcomes.success & (groups == group)]
        found.append(box_of(values) if values.size else None)
    return found


def _offset(arm: str) -> float:
    return (ARMS.index(arm) - 0.5) * 1.15 * BOX_WIDTH


def _label(path: str) -> str:
    return f"Σ|Δ {name_and_unit(path)[0]}| (°)"


def _panel(path: str, boxes: Mapping[str, list[Box | None]], names: list[str]) -> alt.LayerChart:
    found = [(arm, index, box) for arm, own in boxes.items() for index, box in enumerate(own)]
    known = [(arm, index, box) for arm, index, box in found if box is not None]
    look = [ARM_STYLES[arm] for arm in boxes]
    colour = styles(look, "color")
    places = [index + _offset(arm) for arm, index, _ in known]
    x, left = (
        x_of(field, None, domain=(-0.5, len(names) - 0.5), axis=None) for field in ("x", "left")
    )
    highest = max((max([box.high, *box.beyond]) for _, _, box in known), default=1.0)
    y = y_of("q1", _label(path), domain=(0, 1.05 * highest))
    base = alt.Chart(
        frame(
            {
                "x": places,
                "left": [place - BOX_WIDTH / 2 for place in places],
                "right": [place + BOX_WIDTH / 2 for place in places],
                **{name: [getattr(box, name) for _, _, box in known]
                   for name in ("low", "q1", "median", "q3", "high")},
                "series": [ARM_STYLES[arm].name for arm, _, _ in known],
                "group": [short(names[index]) for _, index, _ in known],
                "trials": [f"{integer(box.count)} successful" for _, _, box in known],
                "middle": [f"{number(box.median)}°" for _, _, box in known],
                "quartiles": [f"{number(box.q1)}° and {number(box.q3)}°" for _, _, box in known],
            }
        )
    ).encode(
        opacity=seen(),
        tooltip=["group:N", alt.Tooltip("series:N", title="arm"), "trials:N",
                 alt.Tooltip("middle:N", title="median"), "quartiles:N"],
        **colour,
    )  # fmt: skip
    side = {"x2": "right:Q"}
    return layers(
        base.mark_rect(fillOpacity=0.25).encode(left, y, y2="q3:Q", **side),
        base.mark_rect(filled=False, strokeWidth=1.6).encode(
            left, alt.Y("q1:Q"), y2="q3:Q", **side
        ),
        base.mark_rule().encode(x, alt.Y("low:Q"), y2="q1:Q"),
        base.mark_rule().encode(x, alt.Y("q3:Q"), y2="high:Q"),
        base.mark_rule(strokeWidth=2.6).encode(left, alt.Y("median:Q"), **side),
        *_beyond(known, places, colour),
        *_nothing(found),
        tick_labels(range(len(names)), names, HEIGHT_PX),
        height=HEIGHT_PX,
        title=f"Path length of {name_and_unit(path)[0]}",
    )  # fmt: skip


def _beyond(
    known: list[tuple[str, int, Box]], places: list[float], colour: Mapping[str, Any]
) -> list[alt.Chart]:
    """Return rings for trials beyond the whiskers."""
    rows = [
        (place, value, ARM_STYLES[arm].name)
        for place, (arm, _, box) in zip(places, known, strict=True)
        for value in box.beyond.tolist()
    ]
    if not rows:
        return []
    columns = {name: [row[i] for row in rows] for i, name in enumerate(("x", "y", "series"))}
    return [
        alt.Chart(frame(columns))
        .mark_point(size=18, strokeWidth=1)
        .encode(alt.X("x:Q"), alt.Y("y:Q"), opacity=seen(), **colour)
    ]


def _nothing(found: list[tuple[str, int, Box | None]]) -> list[alt.Chart]:
    """Return words where no trial succeeded."""
    places = [index + _offset(arm) for arm, index, box in found if box is None]
    if not places:
        return []
    rows = {"x": places, "text": ["no success"] * len(places)}
    place = alt.value(HEIGHT_PX - 3)
    return [words(rows, y=place, angle=270, align="left", baseline="middle", size=10)]


def _data(
    curriculum: Curriculum, tests: Mapping[str, Outcomes], arms: list[str], paths: list[str]
) -> Columns:
    """Return one row per successful trial."""
    variants = [f"variant.{name}" for name in curriculum.parameters]
    columns: dict[str, list[object]] = {
        name: [] for name in ("arm", "group", *variants, "network", "trial")
    }
    lengths: dict[str, list[object]] = {f"path_length.{path}": [] for path in paths}
    for arm in arms:
        outcomes = tests[arm]
        won = np.flatnonzero(outcomes.success)
        groups = curriculum.groups_of(outcomes.variant)[won].tolist()
        columns["arm"] += [arm] * won.size
        columns["group"] += [None if i < 0 else curriculum.groups[i].name for i in groups]
        for index, name in enumerate(variants):
            columns[name] += [
                curriculum.axes[index].value(one) for one in outcomes.variant[won, index]
            ]
        columns["network"] += outcomes.network[won].tolist()
        columns["trial"] += outcomes.repetition[won].tolist()
        for path in paths:
            lengths[f"path_length.{path}"] += outcomes.path_lengths[path][won].tolist()
    return columns | lengths
