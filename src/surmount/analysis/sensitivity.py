"""How much a choice matters: the grouping again with one choice changed at a time."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from surmount.analysis.agreement import adjusted_rand
from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.cut import DEFAULT_CUT_OFF, cut_dendrogram
from surmount.analysis.dendrogram import build_dendrogram
from surmount.analysis.features import VariantSamples
from surmount.analysis.fitting import FitSamples, affordable_components, mixture_of
from surmount.analysis.groups import merge_small, small_limit
from surmount.analysis.hellinger import hellinger_matrix
from surmount.analysis.mixture import Mixture
from surmount.analysis.progress import Progress, counter, silent
from surmount.analysis.reference import DistanceCheck
from surmount.analysis.threads import spread
from surmount.core.arrays import FloatArray, IntArray

_LINKAGES = ("average", "complete", "single", "weighted", "ward")
_DEPTHS = (2, 3, 4, 0)
_ALIKE = (0.0, 0.1, 0.3)
_REGULARISATIONS = (1e-4, 1e-2)
"""The larger one blurs behaviours by a tenth of each feature's standard deviation."""
_MOST_NETWORKS = 10
"""Of more networks, the first ones are looked at by themselves."""
NETWORKS = "networks"
"""Choice under which each network by itself stands."""
FEATURES = "features"
"""Choice under which the grouping without each feature stands."""
_WITHOUT = "without "


@dataclass(frozen=True, kw_only=True)
class SensitivityRow:
    """The grouping with one choice changed.

    Attributes
    ----------
    choice, value
        What was changed, and to what.
    n_groups
        Groups after small ones were merged.
    agreement
        Adjusted Rand index with the analysis's own grouping; 1 means the same grouping.
    """

    choice: str
    value: str
    n_groups: int
    agreement: float


def deciding_features(rows: Sequence[SensitivityRow], n_groups: int) -> tuple[str, ...]:
    """Return the features without each of which all variants are one group, where there were more.

    Parameters
    ----------
    rows
        Of an analysis.
    n_groups
        Its groups.
    """
    if n_groups < 2:
        return ()
    return tuple(
        row.value.removeprefix(_WITHOUT)
        for row in rows
        if row.choice == FEATURES and row.n_groups == 1
    )


def group_variants(distances: FloatArray, config: AnalysisConfig) -> IntArray:
    """Return the group of each variant from the distances alone, shape ``(variant,)``."""
    dendrogram = build_dendrogram(distances, config.linkage)
    cut = cut_dendrogram(dendrogram, distances, config)
    limit = small_limit(distances.shape[0], config)
    return merge_small(cut.labels, dendrogram, distances, limit)[0]


def marginal(mixture: Mixture, kept: Sequence[int]) -> Mixture:
    """Return the mixture of some of the features, which needs no new fit."""
    columns = np.asarray(kept, dtype=np.int64)
    return Mixture(
        weights=mixture.weights,
        means=mixture.means[:, columns],
        covariances=mixture.covariances[:, columns[:, None], columns],
    )


def assess_sensitivity(
    data: VariantSamples,
    mixtures: Sequence[Mixture],
    distances: FloatArray,
    labels: IntArray,
    config: AnalysisConfig,
    *,
    seed: int,
    check: DistanceCheck | None = None,
    progress: Progress = silent,
) -> tuple[SensitivityRow, ...]:
    """Repeat the grouping with one choice changed at a time.

    Linkage, cut rule, cut-off and the size of small groups reuse the distances; leaving a feature
    out reuses the mixtures, whose marginals are exact; other numbers of components, another
    regularisation, and each network by itself, are fitted anew. Pooled networks can hide a
    boundary that only one has.

    Parameters
    ----------
    data
        Samples of the analysis.
    mixtures, distances, labels
        Its mixtures, distances and groups.
    config
        Its configuration.
    seed
        Seed of its fits.
    check
        Its distances' references, where they were computed.
    progress
        Told after each choice.
    """
    names = data.features.names
    counts = _other_counts(mixtures, config)
    variances = [one for one in _REGULARISATIONS if one != config.regularisation]
    networks = list(_single_networks(data, config))
    rules = list(_changed_rules(config))
    left_out = range(len(names) if len(names) > 1 else 0)
    total = len(rules) + len(left_out) + len(counts) + len(variances) + len(networks)
    advance = counter(progress, "sensitivity", total + (check is not None))

    def row(choice: str, value: str, found: IntArray) -> SensitivityRow:
        advance()
        return SensitivityRow(
            choice=choice,
            value=value,
            n_groups=int(found.max()) + 1,
            agreement=adjusted_rand(found, labels),
        )

    rows = [
        row(choice, value, group_variants(distances, changed)) for choice, value, changed in rules
    ]
    if check is not None:
        rows.append(row("distances", "reference", group_variants(check.reference, config)))
    for place in left_out:
        kept = [index for index in range(len(names)) if index != place]
        partial = hellinger_matrix([marginal(mixture, kept) for mixture in mixtures])
        rows.append(row(FEATURES, f"{_WITHOUT}{names[place]}", group_variants(partial, config)))
    for count in counts:
        refitted = hellinger_matrix(refits(data.samples, data, count, config, seed))
        rows.append(row("components", str(count), group_variants(refitted, config)))
    usual = max(mixture.n_components for mixture in mixtures)
    for variance in variances:
        changed = dataclasses.replace(config, regularisation=variance)
        refitted = hellinger_matrix(refits(data.samples, data, usual, changed, seed))
        rows.append(row("regularisation", f"{variance:g}", group_variants(refitted, config)))
    for network, samples in networks:
        alone = hellinger_matrix(refits(samples, data, usual, config, seed))
        rows.append(row(NETWORKS, f"only {network}", group_variants(alone, config)))
    return tuple(rows)


def _changed_rules(config: AnalysisConfig) -> Iterator[tuple[str, str, AnalysisConfig]]:
    for linkage in _LINKAGES:
        if linkage != config.linkage:
            changed = dataclasses.replace(config, linkage=linkage)
            yield "linkage", linkage, changed
    cut_off = config.cut_off or DEFAULT_CUT_OFF.get(config.cut, 0.0)
    if cut_off:
        for factor in (0.8, 0.9, 1.1, 1.2):
            changed = dataclasses.replace(config, cut_off=factor * cut_off)
            yield "cut-off", f"{factor * cut_off:.3g}", changed
    if config.cut == "abrupt":
        for distance in _ALIKE:
            if distance != config.alike_distance:
                changed = dataclasses.replace(config, alike_distance=distance)
                yield "alike distance", f"{distance:g}", changed
    for depth in _DEPTHS:
        changed = dataclasses.replace(
            config,
            cut="inconsistency",
            cut_off=1.15 if depth == 2 else 0.0,
            inconsistency_depth=depth,
        )
        yield "cut", f"inconsistency, {f'depth {depth}' if depth else 'full depth'}", changed
    if config.cut != "largest gap":
        yield "cut", "largest gap", dataclasses.replace(config, cut="largest gap")
    if config.cut != "silhouette":
        yield "cut", "silhouette", dataclasses.replace(config, cut="silhouette")
    if config.cut != "abrupt":
        yield "cut", "abrupt", dataclasses.replace(config, cut="abrupt", cut_off=0.0)
    for size in (0, 1, 2, 3):
        if size != config.small_group_size:
            yield "small groups", str(size), dataclasses.replace(config, small_group_size=size)


def _other_counts(mixtures: Sequence[Mixture], config: AnalysisConfig) -> list[int]:
    own = max(mixture.n_components for mixture in mixtures)
    more = min(own + own // 2, max(own, config.max_components))
    return [count for count in (max(2, own // 2), more) if count != own]


def _single_networks(
    data: VariantSamples, config: AnalysisConfig
) -> Iterator[tuple[str, list[FloatArray]]]:
    """Yield the samples of each of several networks that tried every variant often enough."""
    networks = np.unique(data.network)
    for network in networks[:_MOST_NETWORKS] if networks.size > 1 else ():
        own = [
            samples[data.network[trial] == network]
            for samples, trial in zip(data.samples, data.trial, strict=True)
        ]
        if min(samples.shape[0] for samples in own) >= config.min_samples_per_component:
            yield data.network_name(int(network)), own


def refits(
    parts: Sequence[FloatArray],
    data: VariantSamples,
    count: int,
    config: AnalysisConfig,
    seed: int,
) -> list[Mixture]:
    """Return mixtures of samples of each variant, fitted quickly: from one start.

    Parameters
    ----------
    parts
        Standardised samples of each variant, ``(sample, feature)`` each.
    data
        How they were standardised.
    count
        Components, fewer where samples are few.
    config, seed
        Of the fits.
    """
    quick = dataclasses.replace(config, restarts=1)

    def refit(samples: FloatArray) -> Mixture:
        prepared = FitSamples(samples)
        affordable = min(count, affordable_components(prepared.n_samples, config))
        fit = prepared.fit(affordable, quick, seed)
        return mixture_of(fit, data.features.scaling, quick, affordable)

    return spread(refit, parts)
