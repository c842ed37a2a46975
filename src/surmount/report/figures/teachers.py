"""Figures of a comparison of teachers: every network's success, and what each teacher sampled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import altair as alt
import numpy as np

from surmount.analysis.features import describe_variant
from surmount.core.arrays import FloatArray
from surmount.core.axis import axes_from_record
from surmount.report.document.parts import Figure
from surmount.report.document.text import percent, percent_interval, short
from surmount.report.figures.charts import figure, frame, layers, x_of
from surmount.report.figures.palette import ARM_STYLES, INK, SEQUENTIAL
from surmount.stats.evidence import interquartile_mean
from surmount.workflow.run_layout import CURRICULUM

ROW_PX = 34
MAP_PX = 170
DARKEST = 0.99
"""Of all cells so many are told apart by their colour: a few cells of one teacher that are darker
must not make all others pale."""

Record = Mapping[str, Any]


def score_figure(record: Record) -> Figure:
    """Draw the interquartile mean of each teacher, its interval, and every network."""
    teachers: Sequence[Record] = record["teachers"]
    whole = [teacher["interquartile_mean"] for teacher in teachers]
    titles = [teacher["title"] for teacher in teachers]
    points = [
        (title, network, interquartile_mean({title: np.asarray([rates], dtype=np.float64)}))
        for title, teacher in zip(titles, teachers, strict=True)
        for network, rates in enumerate(teacher["success"])
    ]
    ends = {
        end: [one["estimate"] if one[end] is None else one[end] for one in whole]
        for end in ("lower", "upper")
    }
    return Figure(
        name="teachers-success",
        label="",
        title="Success by teacher",
        caption=(
            (
                "Rings: every network's interquartile mean over the variants. Dots and lines: that "
                "over networks and variants, with its 95 % bootstrap interval."
            ),
        ),
        alternative="Rings for networks, and a dot with an interval, in one row per teacher: "
        + "; ".join(
            f"{title} {percent(one['estimate'])}" for title, one in zip(titles, whole, strict=True)
        )
        + ".",
        chart=figure([_scores(titles, whole, ends, points)], columns=1, least_px=320, pick=False),
        data={
            "teacher": [*titles, *(title for title, _, _ in points)],
            "network": [*[None] * len(titles), *(network for _, network, _ in points)],
            "estimate": [*(one["estimate"] for one in whole), *(own for _, _, own in points)],
            "lower": [*ends["lower"], *[None] * len(points)],
            "upper": [*ends["upper"], *[None] * len(points)],
        },
    )


def _scores(
    titles: Sequence[str],
    whole: Sequence[Record],
    ends: Mapping[str, Sequence[float]],
    points: Sequence[tuple[str, int, float]],
) -> alt.LayerChart:
    rows = alt.Y(
        "teacher:N",
        sort=None,
        title=None,
        scale=alt.Scale(domain=[short(title) for title in titles]),
        axis=alt.Axis(grid=True, ticks=False, domain=False, labelLimit=200),
    )
    networks = frame(
        {
            "teacher": [short(title) for title, _, _ in points],
            "x": [own for _, _, own in points],
            "network": [f"network {network}" for _, network, _ in points],
            "success": [percent(own, 1) for _, _, own in points],
        }
    )
    means = frame(
        {
            "teacher": [short(title) for title in titles],
            "x": [one["estimate"] for one in whole],
            **ends,
            "success": [percent(one["estimate"], 1) for one in whole],
            "interval": [percent_interval(one["lower"], one["upper"]) for one in whole],
        }
    )
    x = x_of(
        "x",
        "interquartile mean of success",
        domain=(-0.02, 1.02),
        axis=alt.Axis(format=".0%", grid=False),
    )
    base = alt.Chart(means).encode(rows, tooltip=["teacher:N", "success:N", "interval:N"])
    return layers(
        base.mark_rule(color=INK, strokeWidth=2).encode(alt.X("lower:Q"), x2="upper:Q"),
        alt.Chart(networks)
        .mark_point(size=55, strokeWidth=1.4, color=ARM_STYLES[CURRICULUM].colour, opacity=0.9)
        .encode(x, rows, tooltip=["teacher:N", "network:N", "success:N"]),
        base.mark_point(filled=True, size=90, color=INK, opacity=1).encode(x),
        height=ROW_PX * len(titles),
    )


def sampled_figure(record: Record) -> Figure:
    """Draw on which variants the episodes were, as a map of time and variants per teacher."""
    axes = axes_from_record(record.get("axes", {}), record["parameters"])
    labels = [describe_variant(variant, axes) for variant in record["variants"]]
    found = {teacher["title"]: _shares(teacher["sampled"]) for teacher in record["teachers"]}
    known = np.concatenate([share[np.isfinite(share)] for share in found.values()])
    top = float(np.quantile(known, DARKEST)) if known.size else 1.0
    beyond = bool(known.size) and known.max() > top
    caption = [
        (
            "Episodes that ended in each twentieth of the training, over all networks; from none, "
            f"white, to {percent(top)} of them on one variant, darkest."
        )
    ]
    if beyond:
        caption.append(f"Few cells hold more, up to {percent(float(known.max()))}.")
    rows = [
        (title, part + 1, label, float(share[part, column]))
        for title, share in found.items()
        for part in range(len(share))
        for column, label in enumerate(labels)
    ]
    return Figure(
        name="teachers-sampled",
        label="",
        title="Share of episodes on each variant over the training",
        caption=tuple(caption),
        alternative="One map per teacher: time to the right, variants upwards, dark where many "
        "episodes were.",
        chart=figure(
            [_map(title, share, labels, top) for title, share in found.items()],
            columns=3,
            least_px=270,
            pick=False,
        ),
        data={
            name: [row[index] for row in rows]
            for index, name in enumerate(("teacher", "part", "variant", "share"))
        },
    )


def _map(title: str, share: FloatArray, labels: Sequence[str], top: float) -> alt.LayerChart:
    parts = len(share)
    part, variant = (side.ravel() for side in np.indices(share.shape))
    cells = frame(
        {
            "x": 100 * part / parts,
            "x2": 100 * (part + 1) / parts,
            "variant": [short(labels[int(index)]) for index in variant],
            "share": share.ravel(),
            "time": [
                f"{100 * index / parts:.0f} to {100 * (index + 1) / parts:.0f} % of the training"
                for index in part
            ],
            "episodes": [
                "none ended" if np.isnan(one) else f"{percent(float(one), 1)} of them"
                for one in share.ravel()
            ],
        }
    )
    ticks = np.unique(np.linspace(0, len(labels) - 1, 6).round().astype(int))
    heat = (
        alt.Chart(cells)
        .mark_rect()
        .encode(
            x_of("x", "part of the training (%)", domain=(0, 100), axis=alt.Axis(grid=False)),
            alt.Y(
                "variant:N",
                title="variant",
                scale=alt.Scale(domain=[short(label) for label in labels[::-1]], padding=0),
                axis=alt.Axis(values=[short(labels[int(tick)]) for tick in ticks], grid=False),
            ),
            x2="x2:Q",
            fill=alt.Fill(
                "share:Q",
                title=None,
                scale=alt.Scale(domain=[0, top], range=list(SEQUENTIAL), clamp=True),
                legend=None,
            ),
            tooltip=["variant:N", "time:N", "episodes:N"],
        )
    )
    return layers(heat, height=MAP_PX, title=short(title))


def _shares(counts: Sequence[Sequence[float]]) -> FloatArray:
    """Return each part's shares, NaN where no episode ended."""
    found = np.asarray(counts, dtype=np.float64)
    total = found.sum(axis=1, keepdims=True)
    return np.where(total > 0, found / np.maximum(total, 1), np.nan)


def differences_panel(
    title: str,
    rows: Sequence[tuple[str, Record]],
    points: Sequence[tuple[str, int, float]],
    x_title: str,
) -> alt.LayerChart:
    """Return paired differences with their intervals, one row per teacher, and every network's.

    Parameters
    ----------
    title
        Of the panel.
    rows
        Teachers with an interval: ``estimate``, ``lower`` and ``upper`` as shares.
    points
        Teacher, network and difference of each pair; none where they are not known.
    x_title
        Of the axis.
    """
    names = [short(name) for name, _ in rows]
    y = alt.Y(
        "teacher:N",
        sort=None,
        title=None,
        scale=alt.Scale(domain=names),
        axis=alt.Axis(grid=True, ticks=False, domain=False, labelLimit=200),
    )
    base = alt.Chart(
        frame(
            {
                "teacher": names,
                **{end: [100 * one[end] for _, one in rows]
                   for end in ("estimate", "lower", "upper")},
                "difference": [f"{100 * one['estimate']:+.1f} points" for _, one in rows],
                "interval": [
                    f"{100 * one['lower']:+.1f} to {100 * one['upper']:+.1f}" for _, one in rows
                ],
            }
        )
    ).encode(y, tooltip=["teacher:N", "difference:N", "interval:N"])  # fmt: skip
    zero = (
        alt.Chart(frame({"x": [0.0]})).mark_rule(color=INK, strokeDash=[4, 3]).encode(alt.X("x:Q"))
    )
    parts = [
        base.mark_rule(color=INK, strokeWidth=2).encode(
            x_of("lower", x_title, axis=alt.Axis(grid=False)), x2="upper:Q"
        ),
        base.mark_point(filled=True, size=90, color=INK, opacity=1).encode(alt.X("estimate:Q")),
        zero.mark_rule(color=INK, strokeDash=[4, 3]),
    ]
    if points:
        own = frame(
            {
                "teacher": [short(name) for name, _, _ in points],
                "x": [100 * difference for _, _, difference in points],
                "network": [f"network {network}" for _, network, _ in points],
                "difference": [f"{100 * difference:+.1f} points" for _, _, difference in points],
            }
        )
        parts.append(
            alt.Chart(own)
            .mark_point(size=45, strokeWidth=1.3, color=ARM_STYLES[CURRICULUM].colour, opacity=0.9)
            .encode(alt.X("x:Q"), y, tooltip=["teacher:N", "network:N", "difference:N"])
        )
    return layers(*parts, height=ROW_PX * len(rows), title=title)
