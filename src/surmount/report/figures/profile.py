"""Performance profiles: how large a share of all success rates lies above each rate."""

from __future__ import annotations

from collections.abc import Mapping

import altair as alt

from surmount.report.document.parts import Columns, Figure
from surmount.report.document.text import percent
from surmount.report.figures.charts import figure, frame, layers, seen, shares, styles, x_of
from surmount.report.figures.palette import ARM_STYLES
from surmount.stats.profile import PerformanceProfile
from surmount.workflow.run_layout import ARMS

HEIGHT_PX = 250
WIDTH_PX = 620
LEAST_PX = 340
X_TITLE, Y_TITLE = "success rate", "share of networks and variants above"


def profiles(found: Mapping[str, PerformanceProfile]) -> Figure:
    """Draw the profile of each arm with its limits over networks (Agarwal et al. 2021)."""
    return Figure(
        name="figure-11-profiles",
        label="Figure 11",
        title="Performance profiles",
        caption=(
            (
                "Share of all success rates, one per network and variant, that lie above the rate "
                "on the axis; bands are 95 % bootstrap limits over networks. The higher curve is "
                "better; where curves cross, neither arm is better throughout."
            ),
        ),
        alternative="Performance profiles of curriculum and control.",
        chart=figure([_panel(found)], columns=1, least_px=LEAST_PX, zoom=True, width_px=WIDTH_PX),
        data=_data(found),
    )


def _panel(found: Mapping[str, PerformanceProfile]) -> alt.LayerChart:
    columns: dict[str, list[object]] = {
        name: [] for name in ("x", "y", "lower", "upper", "series", "told")
    }
    for arm in ARMS:
        profile, size = found[arm], len(found[arm].thresholds)
        known = profile.reason is None
        columns["x"] += profile.thresholds
        columns["y"] += profile.share
        columns["lower"] += profile.lower if known else [None] * size
        columns["upper"] += profile.upper if known else [None] * size
        columns["series"] += [ARM_STYLES[arm].name] * size
        columns["told"] += [
            f"{percent(share, 1)} lie above {percent(threshold)}"
            for threshold, share in zip(profile.thresholds, profile.share, strict=True)
        ]
    look = [ARM_STYLES[arm] for arm in ARMS]
    base = alt.Chart(frame(columns)).encode(
        x_of("x", X_TITLE, domain=(0, 1), axis=alt.Axis(format=".0%", grid=False))
    )
    return layers(
        base.mark_area(interpolate="step-after", clip=True).encode(
            shares(Y_TITLE, "lower", top=1.04), y2="upper:Q", opacity=seen(0.18),
            **styles(look, "color"),
        ),
        base.mark_line(interpolate="step-after", clip=True).encode(
            alt.Y("y:Q"), opacity=seen(), **styles(look, "color", "strokeDash")
        ),
        base.mark_point(filled=True, size=50, clip=True).encode(
            alt.Y("y:Q"),
            opacity=alt.value(0),
            tooltip=[alt.Tooltip("series:N", title="arm"), alt.Tooltip("told:N", title="rates")],
        ),
        height=HEIGHT_PX,
    )  # fmt: skip


def _data(found: Mapping[str, PerformanceProfile]) -> Columns:
    columns: dict[str, list[object]] = {
        name: [] for name in ("arm", "success_rate", "share_above", "lower", "upper")
    }
    for arm in ARMS:
        profile = found[arm]
        columns["arm"] += [arm] * len(profile.thresholds)
        columns["success_rate"] += profile.thresholds
        columns["share_above"] += profile.share
        columns["lower"] += profile.lower
        columns["upper"] += profile.upper
    return columns
