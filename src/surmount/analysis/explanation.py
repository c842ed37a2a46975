"""A curriculum and its reasons in words, as lines of plain text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from surmount.analysis.component_count import BICCurve
from surmount.analysis.dendrogram import Dendrogram
from surmount.analysis.features import describe_variant
from surmount.analysis.result import Analysis
from surmount.analysis.stability import Stability
from surmount.core.arrays import FloatArray
from surmount.core.curriculum import Box, Curriculum


def describe_curriculum(curriculum: Curriculum) -> list[str]:
    """Return groups, ranges, success, levels and weights of a curriculum as lines of text."""
    n_groups, n_levels = len(curriculum.groups), curriculum.n_levels
    rows = [
        [
            group.name,
            describe_variants(group.variants),
            f"{group.success_rate:.1%}",
            ", ".join(_describe_box(box) for box in group.boxes[:6])
            + (f" and {len(group.boxes) - 6} more" if len(group.boxes) > 6 else ""),
        ]
        for group in curriculum.groups
    ]
    size = f"{_count(n_groups, 'group')}, {_count(n_levels, 'level')}"
    lines = [
        f"Curriculum over {', '.join(curriculum.parameters)}: {size}",
        "",
        *table_lines(["group", "variants", "success", "range"], rows),
        "",
    ]
    if not curriculum.levels:
        return [
            *lines,
            f"No levels: every group reaches {curriculum.success_threshold:.0%} success.",
        ]
    levels = [
        [str(number), level.dominant, *(f"{weight:.3g}" for weight in level.weights)]
        for number, level in enumerate(curriculum.levels, start=1)
    ]
    names = [group.name for group in curriculum.groups]
    return [*lines, *table_lines(["level", "for", *names], levels)]


def explain_analysis(analysis: Analysis) -> list[str]:
    """Walk the evidence from trials to levels, as lines that a reviewer can check."""
    return [
        *_section("Warnings", analysis.warnings or ["None."]),
        *_section("1. Trials", _explain_trials(analysis)),
        *_section("2. Mixtures", _explain_mixtures(analysis)),
        *_section("3. Distances", _explain_distances(analysis)),
        *_section("4. Links of the dendrogram, lowest first", _explain_links(analysis)),
        *_section("5. Small groups", _explain_merges(analysis)),
        *_section("6. Groups and levels", describe_curriculum(analysis.curriculum)),
        *_section("7. How sure it is", _explain_stability(analysis)),
        *_section("8. How much each choice matters", _explain_sensitivity(analysis)),
    ]


def describe_variants(variants: FloatArray) -> str:
    """Return variants in few words: evenly spaced runs of one parameter as ``21–33 (13)``."""
    if variants.shape[1] > 1:
        shown = ", ".join(describe_variant(variant) for variant in variants[:4])
        return shown + (f" … ({variants.shape[0]})" if variants.shape[0] > 4 else "")
    values = variants[:, 0]
    if values.size < 3:
        return ", ".join(f"{value:g}" for value in values)
    step = np.diff(values).min()
    runs = np.split(values, np.flatnonzero(np.diff(values) > 1.5 * step) + 1)
    parts = [f"{run[0]:g}–{run[-1]:g}" if run.size > 1 else f"{run[0]:g}" for run in runs]
    return f"{', '.join(parts)} ({values.size})"


def table_lines(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return rows as lines of aligned columns."""
    widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]

    def line(cells: Sequence[str]) -> str:
        aligned = (cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
        return ("  " + "  ".join(aligned)).rstrip()

    return [line(header), line(["-" * width for width in widths]), *(line(row) for row in rows)]


def _explain_trials(analysis: Analysis) -> Iterator[str]:
    features = analysis.features
    yield (
        f"{int(analysis.n_trials.sum())} trials on {analysis.variants.shape[0]} variants, "
        f"{int(analysis.n_recorded.sum())} control steps; success per variant is the mean over "
        "the trials of all networks."
    )
    if analysis.stride.max() > 1:
        yield (
            f"Every {int(analysis.stride.min())}th to {int(analysis.stride.max())}th step was used "
            f"(`max_samples` is {analysis.config.max_samples})."
        )
    yield f"Features: {', '.join(features.logged)}; standardised together over all variants."
    if features.reduced:
        yield (
            f"Reduced to {len(features.names)} principal components that keep "
            f"{features.explained_variance:.1%} of the variance."
        )


def _explain_mixtures(analysis: Analysis) -> Iterator[str]:
    where = describe_variant(analysis.variants[analysis.bic_variant])
    if analysis.bic is None:
        yield f"The number of components was given: {analysis.config.components}."
    else:
        yield f"The number of components was chosen on variant {where} by the BIC (eq. 3):"
        yield from _explain_curve(analysis.bic)
        if analysis.bic_per_variant:
            chosen = ", ".join(str(curve.chosen) for curve in analysis.bic_per_variant)
            yield f"Each variant chose its own number: {chosen}."
    fits = [mixture.fit for mixture in analysis.mixtures if mixture.fit]
    yield (
        f"{sum(fit.converged for fit in fits)} of {len(fits)} fits converged, in "
        f"{min(fit.iterations for fit in fits)} to {max(fit.iterations for fit in fits)} "
        f"iterations; {analysis.collapsed} components collapsed; "
        f"{sum(fit.floored for fit in fits)} stand on the regularisation."
    )


def _explain_curve(curve: BICCurve) -> Iterator[str]:
    lowest, fall = min(curve.values), max(curve.values) - min(curve.values)
    for count, value in zip(curve.components, curve.values, strict=True):
        above = (value - lowest) / fall if fall > 0 else 0.0
        mark = " minimum" if count == curve.minimum else ""
        mark += " chosen" if count == curve.chosen else ""
        bar = "#" * round(30 * above)
        yield f"  K = {count:2d}  BIC {value:14.1f}  {bar:30s}{mark}".rstrip()
    yield (
        f"The smallest K within {curve.plateau:.1%} of the whole fall above the minimum is "
        f"{curve.chosen}."
    )


def _explain_distances(analysis: Analysis) -> Iterator[str]:
    n = analysis.variants.shape[0]
    values = analysis.distances[np.triu_indices(n, 1)]
    yield (
        f"Unscented Hellinger distances (eq. 1) of {values.size} pairs: {values.min():.3f} to "
        f"{values.max():.3f}, median {float(np.median(values)):.3f}."
    )


def _explain_links(analysis: Analysis) -> Iterator[str]:
    dendrogram, cut = analysis.dendrogram, analysis.cut
    measure = {"abrupt": "gap/usual", "inconsistency": "inconsistency"}.get(cut.method, "height")
    yield f"Linkage: {analysis.config.linkage}. Cut: {_describe_rule(analysis)}"
    rows: list[list[str]] = []
    whole = _uncut(dendrogram, analysis)
    for link in range(dendrogram.links.shape[0]):
        left, right = dendrogram.children(link)
        decision = "divides" if cut.divided[link] else ("joins" if whole[link] else "above a cut")
        rows.append(
            [
                describe_variants(analysis.variants[dendrogram.leaves(left)]),
                describe_variants(analysis.variants[dendrogram.leaves(right)]),
                f"{dendrogram.heights[link]:.3f}",
                f"{analysis.inconsistency[link]:.2f}",
                f"{analysis.inconsistency_depth_2[link]:.2f}",
                f"{cut.statistic[link]:.2f}",
                decision,
            ]
        )
    header = ["one side", "other side", "height", "incons.", "depth 2", measure, "decision"]
    yield from table_lines(header, rows)


def _describe_rule(analysis: Analysis) -> str:
    cut = analysis.cut
    if cut.method == "abrupt":
        return (
            f"a link divides where its gap is more than {cut.cut_off:g} times the usual gap (lower "
            "quartile) inside the tighter of its two sides."
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


def _describe_box(box: Box) -> str:
    sides = [
        f"{low:g}" if low == high else f"{low:g}–{high:g}"
        for low, high in zip(box.lower, box.upper, strict=True)
    ]
    return " × ".join(sides)


def _section(title: str, lines: Iterator[str] | Sequence[str]) -> list[str]:
    return [title, *(f"  {line}" if line else "" for line in lines), ""]


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
