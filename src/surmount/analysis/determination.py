"""From trials to a curriculum: the whole analysis on one screen (paper II-B, fig. 3)."""

from __future__ import annotations

import numpy as np

from surmount.analysis.component_count import BICCurve
from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.cut import cut_dendrogram
from surmount.analysis.dendrogram import build_dendrogram
from surmount.analysis.expectation_maximisation import Components
from surmount.analysis.features import VariantSamples, variant_samples
from surmount.analysis.fitting import FitSamples, affordable_components, bic_curve, mixture_of
from surmount.analysis.group_boxes import group_boxes
from surmount.analysis.groups import group_names, merge_small, rank_groups, small_limit
from surmount.analysis.hellinger import hellinger_matrix
from surmount.analysis.levels import build_levels
from surmount.analysis.mixture import Mixture
from surmount.analysis.progress import Progress, counter, silent
from surmount.analysis.reference import check_distances
from surmount.analysis.result import Analysis
from surmount.analysis.sensitivity import SensitivityRow, assess_sensitivity
from surmount.analysis.stability import assess_stability
from surmount.analysis.suspects import find_suspects
from surmount.analysis.threads import spread
from surmount.analysis.warnings import analysis_warnings
from surmount.core.arrays import FloatArray
from surmount.core.axis import Axes
from surmount.core.errors import InputError
from surmount.core.seeds import derive_seed, generator
from surmount.tasks.cells import positions
from surmount.tasks.curriculum import Curriculum, Group
from surmount.trials.trials import Trials


def determine_curriculum(
    trials: Trials, config: AnalysisConfig | None = None, *, progress: Progress = silent
) -> Analysis:
    """Determine a curriculum from trials on the variants of a task.

    One mixture per variant (eq. 2, 3), Hellinger distances (eq. 1), agglomerative clustering, a
    cut into groups, small groups merged, groups ranked by success, and one level per group that
    does not yet succeed (eq. 4). The result is a function of the trials, in any order, and the
    configuration.

    Parameters
    ----------
    trials
        Trials on at least two variants.
    config
        Choices; defaults where absent.
    progress
        Told what is being done: the part, how much of it is done, and of how much.

    Returns
    -------
    Analysis
        The curriculum with every number that led to it.

    Raises
    ------
    InputError
        If there is only one variant, a variant has too few samples, a feature is unknown, not
        finite, or no feature varies.
    """
    settings = config or AnalysisConfig()
    data = variant_samples(trials, settings)
    hardest = _bic_variant(data, settings, trials.axes)
    seed = derive_seed(settings.seed, "mixtures")
    curves: list[BICCurve] = []
    if not settings.components:
        chosen = range(len(data.samples)) if settings.components_per_variant else [hardest]
        advance = counter(progress, "number of components", len(chosen))
        for variant in chosen:
            curves.append(bic_curve(FitSamples(data.samples[variant]), settings, seed))
            advance()
    fitted = counter(progress, "mixtures", len(data.samples))

    def fit(variant: int) -> tuple[Components, Mixture]:
        samples = FitSamples(data.samples[variant])
        wanted = settings.components
        if curves:
            wanted = curves[variant if settings.components_per_variant else 0].chosen
        wanted = min(wanted, affordable_components(samples.n_samples, settings))
        found = samples.fit(wanted, settings, seed)
        fitted()
        return found.components, mixture_of(found, data.features.scaling, settings, wanted)

    fits, mixtures = zip(*spread(fit, range(len(data.samples))), strict=True)
    progress("distances", 0, 1)
    distances = hellinger_matrix(mixtures)
    progress("distances", 1, 1)
    check = check_distances(mixtures, seed=settings.seed) if settings.check_distances else None
    dendrogram = build_dendrogram(distances, settings.linkage)
    cut = cut_dendrogram(dendrogram, distances, settings)
    limit = small_limit(len(mixtures), settings)
    labels, merges = merge_small(cut.labels, dendrogram, distances, limit)
    members, rates = rank_groups(labels, data.success_rate)
    names = group_names(len(members))
    for rank, group in enumerate(members):
        labels[group] = rank
    curriculum = Curriculum(
        parameters=trials.parameters,
        groups=tuple(
            Group(
                name=name,
                variants=data.variants[group],
                success_rate=rate,
                boxes=group_boxes(data.variants, group, settings.bounds, trials.axes),
            )
            for name, group, rate in zip(names, members, rates, strict=True)
        ),
        levels=build_levels(names, rates, settings),
        success_threshold=settings.success_threshold,
        axes=trials.axes,
    )
    stability = None
    if settings.bootstrap:
        stability = assess_stability(trials, data, fits, labels, settings, progress)
    sensitivity: tuple[SensitivityRow, ...] = ()
    if settings.sensitivity:
        sensitivity = assess_sensitivity(
            data, mixtures, distances, labels, settings, seed=seed, check=check, progress=progress
        )
    suspects = find_suspects(
        trials,
        data.features.logged,
        mixtures,
        labels,
        settings,
        reduced=data.features.reduced,
        seed=seed,
    )
    recorded, sampled = _scatter(data, mixtures[hardest], hardest, settings)
    analysis = Analysis(
        config=settings,
        parameters=trials.parameters,
        features=data.features,
        n_networks=np.unique(trials.network).size,
        network_names=trials.network_names,
        variants=data.variants,
        success_rate=data.success_rate,
        n_trials=data.n_trials,
        n_recorded=data.n_recorded,
        stride=data.stride,
        bic_variant=hardest,
        bic=_curve_of(curves, hardest, settings),
        bic_per_variant=tuple(curves) if settings.components_per_variant else (),
        mixtures=mixtures,
        distances=distances,
        check=check,
        linkage=dendrogram.links,
        inconsistency=dendrogram.inconsistency(settings.inconsistency_depth),
        inconsistency_depth_2=dendrogram.inconsistency(2),
        cut=cut,
        merges=merges,
        labels=labels,
        curriculum=curriculum,
        recorded=recorded,
        sampled=sampled,
        stability=stability,
        sensitivity=sensitivity,
        suspects=suspects,
        notes=trials.notes,
        warnings=(),
    )
    return analysis_warnings(analysis, outliers=data.outliers)


def _bic_variant(data: VariantSamples, config: AnalysisConfig, axes: Axes) -> int:
    """Return the variant on which K is chosen: the named one, or the hardest.

    The hardest is the one furthest along the direction of difficulty where that is known (over
    several parameters, the sum of its places in their ranges counts), else that of the lowest
    success; of several such variants, the one with the most samples.
    """
    if config.bic_variant:
        wanted = np.asarray(config.bic_variant)
        if wanted.size == data.variants.shape[1]:
            matches = np.isclose(data.variants, wanted, rtol=1e-9).all(axis=1)
            if matches.any():
                return int(np.flatnonzero(matches)[0])
        known = ", ".join(f"{variant.tolist()}" for variant in data.variants[:5])
        raise InputError(
            f"`bic_variant` {list(config.bic_variant)} is not among the recorded variants.",
            remedy=f"Name a recorded variant, such as {known}.",
        )
    difficulty = -data.success_rate
    if config.harder:
        difficulty = _place(data.variants, config.harder, axes)
    hardest = np.flatnonzero(np.isclose(difficulty, difficulty.max(), rtol=0.0, atol=1e-9))
    sizes = [data.samples[variant].shape[0] for variant in hardest]
    return int(hardest[int(np.argmax(sizes))])


def _place(variants: FloatArray, harder: tuple[int, ...], axes: Axes) -> FloatArray:
    """Return how far along the direction of difficulty variants lie, shape ``(variant,)``."""
    if len(harder) != variants.shape[1]:
        raise InputError(
            f"`harder` gives {len(harder)} directions, but the trials have {variants.shape[1]} "
            "task parameters.",
            remedy="Give 1 or -1 for each parameter in their order, or leave it out.",
        )
    return positions(variants, axes) @ np.array(harder, dtype=np.float64)


def _curve_of(curves: list[BICCurve], hardest: int, config: AnalysisConfig) -> BICCurve | None:
    if not curves:
        return None
    return curves[hardest] if config.components_per_variant else curves[0]


def _scatter(
    data: VariantSamples, mixture: Mixture, variant: int, config: AnalysisConfig
) -> tuple[np.ndarray, np.ndarray]:
    samples = data.samples[variant]
    rng = generator(config.seed, "scatter")
    size = min(config.scatter_samples, samples.shape[0])
    rows = np.sort(rng.choice(samples.shape[0], size=size, replace=False))
    scaling = data.features.scaling
    return samples[rows] * scaling.scale + scaling.centre, mixture.sample(rng, size)
