"""Figure 5: recorded features beside features drawn from the mixture, and the BIC curve."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import altair as alt
import numpy as np

from surmount.analysis.component_count import BICCurve
from surmount.analysis.explanation import describe_bic_choice
from surmount.analysis.features import variant_samples
from surmount.analysis.result import Analysis
from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.report.document.parts import Columns, Figure
from surmount.report.document.text import axis_label, name_and_unit
from surmount.report.figures.charts import figure, frame, layers, seen, styles, words, x_of, y_of
from surmount.report.figures.palette import INK, PAPER, RECORDED, Series
from surmount.trials.trials import Trials

SERIES = (
    Series(name="recorded", colour=RECORDED, shape="circle"),
    Series(name="drawn from the mixture", colour="#0072b2", shape="cross"),
)
BINS = 40
MOST_FEATURES = 4
"""Pairs are drawn of so many features: six panels, as in the paper."""
MOST_POINTS = 300
"""Of each kind that are drawn; all of them are in the data."""
HEIGHT_PX = 200
LEAST_PX = 270


@dataclass(frozen=True, kw_only=True, eq=False)
class _Fit:
    """What is drawn of one variant: points recorded on it and points drawn from its mixture."""

    names: tuple[str, ...]
    recorded: FloatArray
    sampled: FloatArray

    def of(self, feature: int) -> tuple[FloatArray, FloatArray]:
        return self.recorded[:, feature], self.sampled[:, feature]


def mixture_fit(analysis: Analysis) -> Figure:
    """Draw all pairs of features of the variant on which K was chosen (paper fig. 5)."""
    names = analysis.features.names[:MOST_FEATURES]
    chosen = analysis.mixtures[analysis.bic_variant].n_components
    where = _variant(analysis, analysis.bic_variant)
    caption = [
        (
            f"Recorded control steps of variant {where} and as many points drawn from its mixture "
            f"of {chosen} Gaussians: the closer the clouds, the better the mixture describes how "
            "it is done there."
        )
    ]
    if len(analysis.recorded) > MOST_POINTS and len(names) > 1:
        caption.append(f"Of each cloud {MOST_POINTS} points are drawn; the data have all.")
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
        chart=_chart(_stored(analysis), analysis.bic),
        data=_data(analysis),
    )


def fit_chart(
    analysis: Analysis, variant: float | str | None = None, trials: Trials | None = None
) -> alt.ConcatChart:
    """Draw the fit on one variant; see :meth:`surmount.Analysis.plot_fit`."""
    index = analysis.bic_variant if variant is None else _index_of(analysis, variant)
    if trials is not None:
        drawn, found = _from_trials(analysis, index, trials), None
    elif index == analysis.bic_variant:
        drawn, found = _stored(analysis), analysis.bic
    else:
        drawn, found = _sampled(analysis, index, MOST_POINTS), None
    return _chart(drawn, found).properties(title=f"Variant {_variant(analysis, index)}")


def _index_of(analysis: Analysis, variant: float | str) -> int:
    labels = analysis.labels_of_variants
    text = variant if isinstance(variant, str) else f"{variant:g}"
    if text not in labels:
        raise InputError(
            f"There is no variant {text}.", remedy=f"Name one of: {', '.join(labels[:12])}."
        )
    return labels.index(text)


def _stored(analysis: Analysis) -> _Fit:
    return _Fit(names=analysis.features.names, recorded=analysis.recorded, sampled=analysis.sampled)


def _sampled(analysis: Analysis, index: int, size: int) -> _Fit:
    drawn = analysis.mixtures[index].sample(np.random.default_rng(0), size)
    return _Fit(names=analysis.features.names, recorded=drawn[:0], sampled=drawn)


def _from_trials(analysis: Analysis, index: int, trials: Trials) -> _Fit:
    data = variant_samples(trials, analysis.config)
    same = np.isclose(data.variants, analysis.variants[index], rtol=1e-9).all(axis=1)
    if not same.any() or data.features.names != analysis.features.names:
        raise InputError(
            f"These trials have no variant {analysis.label(index)} with the features "
            f"{', '.join(analysis.features.names)}.",
            remedy="Give the trials that the analysis was made from.",
        )
    scaling = data.features.scaling
    recorded = data.samples[int(np.flatnonzero(same)[0])] * scaling.scale + scaling.centre
    return _Fit(
        names=analysis.features.names,
        recorded=recorded,
        sampled=_sampled(analysis, index, len(recorded)).sampled,
    )


def _variant(analysis: Analysis, index: int) -> str:
    unit = name_and_unit(analysis.parameters[0])[1] if len(analysis.parameters) == 1 else ""
    return f"{analysis.label(index)} {unit}".strip()


def _bic_sentence(curve: BICCurve) -> str:
    taken = f"K = {curve.chosen} was taken"
    if curve.chosen == curve.minimum:
        return f"{taken}, the minimum of the BIC (eq. 3)."
    return (
        f"{taken}: the smallest K whose BIC (eq. 3) lies within {curve.plateau:.0%} of the "
        f"curve's fall above its minimum at K = {curve.minimum}."
    )


def _chart(fit: _Fit, curve: BICCurve | None) -> alt.ConcatChart:
    pairs = list(itertools.combinations(range(min(MOST_FEATURES, len(fit.names))), 2))
    panels = _clouds(fit, pairs) if pairs else [_histograms(fit)]
    if curve is not None:
        panels.append(_bic_panel(curve))
    return figure(panels, columns=3, least_px=LEAST_PX, zoom=True)


def _clouds(fit: _Fit, pairs: list[tuple[int, int]]) -> list[alt.LayerChart]:
    both = [_thinned(fit.recorded), _thinned(fit.sampled)]
    shown = np.concatenate(both)
    rows: dict[str, list[object]] = {
        "series": [one.name for one, own in zip(SERIES, both, strict=True) for _ in own]
    }
    rows |= {f"f{index}": shown[:, index].tolist() for index in range(shown.shape[1])}
    base = alt.Chart(frame(rows)).mark_point(size=22, strokeWidth=1.1, clip=True)
    return [
        layers(
            base.encode(
                x_of(f"f{first}", axis_label(fit.names[first])),
                y_of(f"f{second}", axis_label(fit.names[second])),
                opacity=seen(0.6),
                **styles(SERIES, "color", "shape"),
            ),
            height=HEIGHT_PX,
        )
        for first, second in pairs
    ]


def _thinned(points: FloatArray) -> FloatArray:
    every = np.linspace(0, len(points) - 1, min(MOST_POINTS, len(points)))
    return points[np.round(every).astype(np.int64), :MOST_FEATURES]


def _histograms(fit: _Fit) -> alt.LayerChart:
    edges = np.histogram_bin_edges(np.concatenate(fit.of(0)), bins=BINS)
    rows: dict[str, list[object]] = {"x": [], "y": [], "series": []}
    for one, values in zip(SERIES, fit.of(0), strict=True):
        share = np.histogram(values, edges)[0] / max(1, values.size)
        rows["x"] += edges.tolist()
        rows["y"] += [*share.tolist(), 0.0]
        rows["series"] += [one.name] * edges.size
    line = (
        alt.Chart(frame(rows))
        .mark_line(interpolate="step-after", clip=True)
        .encode(
            x_of("x", axis_label(fit.names[0])),
            y_of("y", "share", zero=True),
            opacity=seen(),
            **styles(SERIES, "color"),
        )
    )
    return layers(line, height=HEIGHT_PX)


def _bic_panel(curve: BICCurve) -> alt.LayerChart:
    values = [value / 1000 for value in curve.values]
    base = alt.Chart(
        frame(
            {
                "x": curve.components,
                "y": values,
                "K": [str(count) for count in curve.components],
                "BIC": [f"{value:,.0f}" for value in curve.values],
                "converged": ["yes" if done else "no" for done in curve.converged],
            }
        )
    ).encode(
        x_of("x", "components K", axis=alt.Axis(tickMinStep=1, format="d")),
        y_of("y", "BIC, thousands"),
        tooltip=["K:N", "BIC:N", "converged:N"],
    )
    fill = alt.Fill(
        "converged:N", scale=alt.Scale(domain=["yes", "no"], range=[INK, PAPER]), legend=None
    )
    place = curve.components.index(curve.chosen)
    right = 2 * curve.chosen > curve.components[0] + curve.components[-1]
    taken = {"x": [curve.chosen], "y": [values[place]], "text": [f"K = {curve.chosen} taken"]}
    mark = alt.Chart(frame(taken)).encode(alt.X("x:Q"), alt.Y("y:Q"))
    return layers(
        base.mark_line(color=INK, strokeWidth=1.5, clip=True),
        base.mark_point(color=INK, size=45, opacity=1, clip=True).encode(fill),
        mark.mark_point(color=SERIES[1].colour, size=220, strokeWidth=2.5, clip=True),
        words(
            taken,
            y=alt.value(2),
            align="right" if right else "left",
            baseline="top",
            dx=-5 if right else 5,
        ),
        mark.mark_rule(color=SERIES[1].colour, strokeDash=[2, 2]).encode(
            y=alt.value(0), y2=alt.value(HEIGHT_PX)
        ),
        height=HEIGHT_PX,
    )


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
