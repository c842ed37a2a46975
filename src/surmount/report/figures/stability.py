"""Figure: success on each variant, and how surely the variants belong together."""

from __future__ import annotations

import itertools

import altair as alt

from surmount.analysis.result import Analysis
from surmount.analysis.stability import Stability
from surmount.report.document.parts import Columns, Figure
from surmount.report.document.text import percent, short
from surmount.report.figures.charts import figure, frame, layers, seen, shares, styles
from surmount.report.figures.palette import MUTED
from surmount.report.figures.variant_matrix import (
    group_styles,
    matrix_panel,
    variant_axis,
    variant_names,
)
from surmount.stats.proportions import ProportionIntervals, proportion_intervals

HEIGHT_PX = 290
LEAST_PX = 340


def success_and_stability(analysis: Analysis) -> Figure | None:
    """Draw success by variant and the bootstrap's co-memberships; ``None`` without a bootstrap."""
    stability = analysis.stability
    if stability is None:
        return None
    caption = [
        (
            "Success of the trials on each variant, with Wilson's 95 % intervals, and for every "
            f"two variants the share of {stability.replicates} bootstrap replicates in which they "
            "were in one group: light within the frames and dark outside where the grouping is "
            "sure."
        )
    ]
    if analysis.in_a_row:
        caption.append(
            "Grey bars stand between neighbouring variants: the share of replicates with a "
            "boundary there."
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
        chart=figure(
            [_success_panel(analysis, stability), _matrix_panel(analysis, stability)],
            columns=2,
            least_px=LEAST_PX,
        ),
        data=_data(analysis, stability),
    )


def success_chart(analysis: Analysis) -> alt.ConcatChart:
    """Draw success alone, with boundaries in the bootstrap where there was one."""
    panel = _success_panel(analysis, analysis.stability)
    return figure([panel], columns=1, least_px=LEAST_PX, width_px=600)


def stability_chart(analysis: Analysis, stability: Stability) -> alt.ConcatChart:
    """Draw how often two variants were in one group."""
    return figure([_matrix_panel(analysis, stability)], columns=1, least_px=LEAST_PX, width_px=480)


def _limits(analysis: Analysis) -> ProportionIntervals:
    return proportion_intervals(analysis.trials_won, analysis.n_trials)


def _matrix_panel(analysis: Analysis, stability: Stability) -> alt.LayerChart:
    return matrix_panel(
        analysis,
        stability.co_membership,
        lambda share: f"in one group in {percent(share)} of the replicates",
        height=HEIGHT_PX,
        title="Variants in one group: light is always, dark is never",
        likeness=True,
    )


def _success_panel(analysis: Analysis, stability: Stability | None) -> alt.LayerChart:
    labels, layer = variant_names(analysis), list[alt.Chart]()
    bounds = None if stability is None or not analysis.in_a_row else stability.boundaries
    x = variant_axis(analysis, alt.X, "variant")
    y_title = f"share of trials{' or replicates' if bounds is not None else ''}"
    if bounds is not None:
        rows = {
            "variant": labels[:-1],
            "y": bounds,
            "between": [f"{a} and {b}" for a, b in itertools.pairwise(labels)],
            "boundary": [f"in {percent(float(share))} of the replicates" for share in bounds],
        }
        layer.append(
            alt.Chart(frame(rows))
            .mark_rule(color=MUTED, strokeWidth=6, opacity=0.6)
            .encode(
                variant_axis(analysis, alt.X, "variant", bandPosition=1),
                shares(y_title),
                y2=alt.datum(0),
                tooltip=["between:N", "boundary:N"],
            )
        )
    limits = _limits(analysis)
    names = [short(analysis.groups[group].name) for group in analysis.labels]
    base = alt.Chart(
        frame(
            {
                "variant": labels,
                "y": analysis.success_rate,
                "lower": limits.lower,
                "upper": limits.upper,
                "series": names,
                "success": [
                    f"{percent(float(rate))} of {tried} trials"
                    for rate, tried in zip(analysis.success_rate, analysis.n_trials, strict=True)
                ],
            }
        )
    ).encode(
        x, tooltip=["variant:N", alt.Tooltip("series:N", title="group"), "success:N"],
        opacity=seen(),
    )  # fmt: skip
    look = group_styles(analysis)
    layer += [
        base.mark_rule(strokeWidth=1.4).encode(
            shares(y_title, "lower"), y2="upper:Q", **styles(look, "color")
        ),
        base.mark_point(filled=True, size=60).encode(
            shares(y_title), **styles(look, "color", "shape")
        ),
    ]
    title = "Success, and boundaries" if bounds is not None else "Success"
    return layers(*layer, height=HEIGHT_PX, title=title)


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
