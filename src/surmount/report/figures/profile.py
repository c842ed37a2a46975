"""Performance profiles: how large a share of all success rates lies above each rate."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import plotly.graph_objects as go
from matplotlib.figure import Figure as StillFigure

from surmount.report.document.parts import Columns, Figure, Panel
from surmount.report.figures.palette import ARM_STYLES, arm_lines, translucent
from surmount.report.figures.plots import hover, plot
from surmount.report.figures.stills import axes_grid
from surmount.stats.profile import PerformanceProfile
from surmount.workflow.run_layout import ARMS

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
        legend=arm_lines(ARMS),
        panels=(Panel(plot=_panel(found), height_px=300),),
        panel_width_px=480,
        still=lambda: _still(found),
        data=_data(found),
    )


def _panel(found: Mapping[str, PerformanceProfile]) -> go.Figure:
    figure = plot(x_title=X_TITLE, y_title=Y_TITLE)
    for arm in ARMS:
        style, profile = ARM_STYLES[arm], found[arm]
        if profile.reason is None:
            for limit, fill in ((profile.upper, None), (profile.lower, "tonexty")):
                figure.add_trace(
                    go.Scatter(
                        x=profile.thresholds,
                        y=limit,
                        mode="lines",
                        line={"width": 0, "shape": "hv"},
                        fill=fill,
                        fillcolor=translucent(style.colour, 0.15),
                        hoverinfo="skip",
                    )
                )
        figure.add_trace(
            go.Scatter(
                x=profile.thresholds,
                y=profile.share,
                mode="lines",
                line={"color": style.colour, "width": 2.2, "dash": style.dash, "shape": "hv"},
                hovertext=[
                    hover(f"{style.name}: {100 * share:.1f} % above {100 * threshold:.0f} %")
                    for threshold, share in zip(profile.thresholds, profile.share, strict=True)
                ],
                hoverinfo="text",
            )
        )
    figure.update_xaxes(range=[0, 1], tickformat=".0%")
    figure.update_yaxes(range=[0, 1.04], tickformat=".0%")
    return figure


def _still(found: Mapping[str, PerformanceProfile]) -> StillFigure:
    figure, (ax,) = axes_grid(1, 1, height_in=2.8, width_in=4.6)
    for arm in ARMS:
        style, profile = ARM_STYLES[arm], found[arm]
        if profile.reason is None:
            lower, upper = (
                np.asarray(limit, dtype=np.float64) for limit in (profile.lower, profile.upper)
            )
            ax.fill_between(
                profile.thresholds, lower, upper, step="post", color=style.colour, alpha=0.15, lw=0
            )
        ax.step(
            profile.thresholds,
            profile.share,
            where="post",
            color=style.colour,
            ls=style.line,
            label=style.name,
        )
    ax.set(xlim=(0, 1), ylim=(0, 1.04), xlabel=X_TITLE, ylabel=Y_TITLE)
    ax.grid(visible=True)
    ax.legend(loc="lower left")
    return figure


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
