"""The reasons for a curriculum in words: the evidence from trials to levels, line by line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from surmount.analysis.component_count import BICCurve
from surmount.analysis.cut import link_gaps
from surmount.analysis.dendrogram import Dendrogram
from surmount.analysis.description import (
    describe_curriculum,
    describe_variants,
    table_lines,
)
from surmount.analysis.features import describe_variant
from surmount.analysis.reference import DistanceCheck
from surmount.analysis.result import Analysis
from surmount.analysis.stability import Stability
from surmount.analysis.trust import describe_trust
from surmount.core.arrays import FloatArray

_NONE = "–"


def explain_analysis(analysis: Analysis) -> list[str]:
    """Walk the evidence from trials to levels, as lines that a reviewer can check."""
    return [
        *_section("How far to trust it", describe_trust(analysis)),
        *_section("Warnings", analysis.warnings or ["None."]),
        *_section("1. Trials", _explain_trials(analysis)),
        *_section("2. Mixtures", _explain_mixtures(analysis)),
        *_section("3. Distances", _explain_distances(analysis)),
        *_section("4. Links of the dendrogram, lowest first", _explain_links(analysis)),
        *_section("5. Small groups", _explain_merges(analysis)),
        *_section("6. Groups and levels", _explain_groups(analysis)),
        *_section("7. How sure it is", _explain_stability(analysis)),
        *_section("8. How much each choice matters", _explain_sensitivity(analysis)),
    ]


def _explain_trials(analysis: Analysis) -> Iterator[str]:
    features = analysis.features
    yield (
        f"{int(analysis.n_trials.sum())} trials on {analysis.variants.shape[0]} variants by "
        f"{analysis.networks}, "
        f"{int(analysis.n_recorded.sum())} control steps."
    )
    if analysis.stride.max() > 1:
        yield (
            f"Every {int(analysis.stride.min())}th to {int(analysis.stride.max())}th step was used "
            f"(`max_samples` is {analysis.config.max_samples} per variant)."
        )
    yield f"Features: {', '.join(features.logged)}; standardised together over all variants."
    if features.dropped:
        yield f"Left out as constant: {', '.join(features.dropped)}."
    if features.reduced:
        yield (
            f"Reduced to {len(features.names)} principal components that keep "
            f"{features.explained_variance:.1%} of the variance."
        )
    rows = [
        [
            describe_variant(variant),
            str(int(analysis.n_trials[index])),
            str(int(analysis.n_recorded[index])),
            f"{analysis.success_rate[index]:.1%}",
            analysis.groups[int(analysis.labels[index])].name,
        ]
        for index, variant in enumerate(analysis.variants)
    ]
    yield from table_lines(["variant", "trials", "steps", "success", "group"], rows)


def _explain_mixtures(analysis: Analysis) -> Iterator[str]:
    if analysis.bic is None:
        yield f"The number of components was given: {analysis.config.components}."
    else:
        where = describe_variant(analysis.variants[analysis.bic_variant])
        yield (
            f"The number of components was chosen on variant {where}, "
            f"{describe_bic_choice(analysis)}, by the BIC (eq. 3):"
        )
        yield from _explain_curve(analysis.bic)
        if analysis.bic_per_variant:
            chosen = ", ".join(str(curve.chosen) for curve in analysis.bic_per_variant)
            yield f"Each variant chose its own number: {chosen}."
    fits = [mixture.fit for mixture in analysis.mixtures if mixture.fit]
    yield (
        f"{sum(fit.converged for fit in fits)} of {len(fits)} fits converged, after the best of "
        f"{fits[0].restarts} starts in {min(fit.iterations for fit in fits)} to "
        f"{max(fit.iterations for fit in fits)} iterations; {analysis.collapsed} components "
        f"collapsed; {sum(fit.floored for fit in fits)} stand on the regularisation."
    )


def describe_bic_choice(analysis: Analysis) -> str:
    """Return why K was chosen on the variant it was chosen on, as an apposition to it."""
    if analysis.config.bic_variant:
        return "which the configuration names"
    rate = analysis.success_rate[analysis.bic_variant]
    if analysis.config.harder:
        return f"the hardest by the direction of difficulty (success {rate:.1%})"
    return f"that of the lowest success ({rate:.1%})"


def _explain_curve(curve: BICCurve) -> Iterator[str]:
    lowest, fall = min(curve.values), max(curve.values) - min(curve.values)
    for count, value, converged in zip(
        curve.components, curve.values, curve.converged, strict=True
    ):
        above = (value - lowest) / fall if fall > 0 else 0.0
        marks = [
            mark
            for mark, holds in (
                ("minimum", count == curve.minimum),
                ("taken", count == curve.chosen),
                ("not converged", not converged),
            )
            if holds
        ]
        bar = "#" * round(30 * above)
        yield f"  K = {count:2d}  BIC {value:14.1f}  {bar:30s} {', '.join(marks)}".rstrip()
    if curve.plateau > 0:
        yield (
            f"K = {curve.chosen} is the smallest within {curve.plateau:.1%} of the curve's fall "
            "above its minimum (`plateau`)."
        )


def _explain_distances(analysis: Analysis) -> Iterator[str]:
    pairs = np.triu_indices(analysis.variants.shape[0], 1)
    values = analysis.distances[pairs]
    yield (
        f"Unscented Hellinger distances (eq. 1) of {values.size} pairs: {values.min():.3f} to "
        f"{values.max():.3f}, median {float(np.median(values)):.3f}."
    )
    if analysis.check is None:
        yield "Not compared with a reference (`check_distances` is off)."
    else:
        yield from _explain_check(analysis.check, analysis.distances, pairs)


def _explain_check(
    check: DistanceCheck, distances: FloatArray, pairs: tuple[np.ndarray, np.ndarray]
) -> Iterator[str]:
    errors = np.abs(distances - check.reference)[pairs]
    worst = int(np.argmax(errors))
    place = (pairs[0][worst], pairs[1][worst])
    yield (
        f"Compared with quasi-Monte Carlo (standard errors up to "
        f"{check.standard_error.max():.4f}), they are off by {errors.mean():.4f} on average and "
        f"by {errors[worst]:.4f} at most ({distances[place]:.3f} for "
        f"{check.reference[place]:.3f})."
    )


def _explain_links(analysis: Analysis) -> Iterator[str]:
    yield f"Linkage: {analysis.config.linkage}. Cut: {describe_rule(analysis)}"
    yield from table_lines(*link_table(analysis))


def link_table(analysis: Analysis) -> tuple[list[str], list[list[str]]]:
    """Return a heading and a row for each link: what it joins, its measures, and the decision."""
    dendrogram, cut = analysis.dendrogram, analysis.cut
    abrupt = cut.method == "abrupt"
    gaps = link_gaps(dendrogram, analysis.distances) if abrupt else cut.statistic
    header = ["one side", "other side", "height", "incons.", "depth 2", "decision"]
    if abrupt:
        header[3:3] = ["gap", "usual", "ratio"]
    rows: list[list[str]] = []
    whole = _uncut(dendrogram, analysis)
    for link in range(dendrogram.links.shape[0]):
        left, right = dendrogram.children(link)
        row = [
            describe_variants(analysis.variants[dendrogram.leaves(left)]),
            describe_variants(analysis.variants[dendrogram.leaves(right)]),
            f"{dendrogram.heights[link]:.3f}",
            f"{analysis.inconsistency[link]:.2f}",
            f"{analysis.inconsistency_depth_2[link]:.2f}",
            "divides" if cut.divided[link] else ("joins" if whole[link] else "above a cut"),
        ]
        if abrupt:
            row[3:3] = _gap_cells(float(gaps[link]), float(cut.statistic[link]))
        rows.append(row)
    return header, rows


def _gap_cells(gap: float, ratio: float) -> list[str]:
    known = ratio > 0
    return [
        f"{gap:.3f}",
        f"{gap / ratio:.3f}" if known else _NONE,
        f"{ratio:.2f}" if known else _NONE,
    ]


def describe_rule(analysis: Analysis) -> str:
    """Return how the cut decided, as the end of a sentence."""
    cut = analysis.cut
    if cut.method == "abrupt":
        return (
            f"a link divides where its gap is more than {cut.cut_off:g} times the usual gap (lower "
            "quartile) inside the tighter of its two sides. A gap is the smallest √(−ln(1 − D²)) "
            f"from one side to the other; sides of fewer than three variants have no usual one "
            f"({_NONE}), and no usual one counts as smaller than that of "
            f"D = {analysis.config.alike_distance:g}."
        )
    if cut.method == "inconsistency":
        depth = analysis.config.inconsistency_depth
        return (
            f"a link divides where its inconsistency over "
            f"{f'depth {depth}' if depth else 'the full depth'} exceeds {cut.cut_off:g}."
        )
    return f"the highest links divide, their number by the rule `{cut.method}`."


def _uncut(dendrogram: Dendrogram, analysis: Analysis) -> list[bool]:
    whole: list[bool] = []
    for link in range(dendrogram.links.shape[0]):
        below = dendrogram.links_below(link)
        whole.append(not bool(analysis.cut.divided[link] or analysis.cut.divided[below].any()))
    return whole


def _explain_merges(analysis: Analysis) -> Iterator[str]:
    if not analysis.merges:
        yield "No group was small enough to be merged into its neighbour."
    for merge in analysis.merges:
        small = describe_variants(analysis.variants[list(merge.members)])
        into = describe_variants(analysis.variants[list(merge.into)])
        yield (
            f"{small} has at most {merge.limit} variants and was merged into {into}, its nearest "
            f"neighbour in the dendrogram (joined at height {merge.height:.3f})."
        )


def _explain_groups(analysis: Analysis) -> Iterator[str]:
    config = analysis.config
    yield (
        "Groups rank by the mean success of their variants; each below "
        f"{config.success_threshold:.0%} gets a level (eq. 4): {config.dominant_weight:g} for "
        f"itself, the rest to the others, {config.harder_share:.0%} of it to harder ones."
    )
    yield ""
    yield from describe_curriculum(analysis.curriculum)


def _explain_stability(analysis: Analysis) -> Iterator[str]:
    stability = analysis.stability
    if stability is None:
        yield "Not assessed: `bootstrap` is 0."
        return
    counts = ", ".join(f"{count} in {share:.0%}" for count, share in stability.group_counts)
    yield (
        f"Networks and trials were drawn again {stability.replicates} times. Number of groups: "
        f"{counts}. Pairs of variants grouped as here: {stability.agreement:.1%}."
    )
    rows = [
        [group.name, str(len(group.variants)), f"{together:.0%}", f"{apart:.0%}"]
        for group, together, apart in zip(
            analysis.groups,
            stability.together(analysis.labels),
            stability.apart(analysis.labels),
            strict=True,
        )
    ]
    yield from table_lines(["group", "variants", "together", "apart"], rows)
    if analysis.variants.shape[1] == 1:
        yield from _explain_boundaries(analysis, stability)


def _explain_boundaries(analysis: Analysis, stability: Stability) -> Iterator[str]:
    for left in np.flatnonzero((np.diff(analysis.labels) != 0) | (stability.boundaries > 0.05)):
        low, high = (describe_variant(analysis.variants[i]) for i in (left, left + 1))
        here = "a boundary" if analysis.labels[left] != analysis.labels[left + 1] else "none"
        yield (
            f"Between {low} and {high}: {here} here, a boundary in "
            f"{stability.boundaries[left]:.0%} of the replicates."
        )


def _explain_sensitivity(analysis: Analysis) -> Iterator[str]:
    if not analysis.sensitivity:
        yield "Not assessed: `sensitivity` is off."
        return
    rows = [
        [row.choice, row.value, str(row.n_groups), f"{row.agreement:.2f}"]
        for row in analysis.sensitivity
    ]
    yield "One choice changed at a time; agreement 1 means the same groups (adjusted Rand index)."
    yield from table_lines(["choice", "changed to", "groups", "agreement"], rows)


def _section(title: str, lines: Iterator[str] | Sequence[str]) -> list[str]:
    return [title, *(f"  {line}" if line else "" for line in lines), ""]
