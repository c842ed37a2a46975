"""From trials to one table of standardised samples per variant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.fitting import Scaling, scaling_of
from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.trials.trials import Trials

_LARGEST_VALUE = 1e100
"""Larger values count as infinite: their squares overflow."""
_FEWEST_FOR_OUTLIERS = 20
_OUTLYING = 1.0
"""Squared distance from the mean, as a share of all others' about theirs, of a value told."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FeatureMap:
    """How logged features become the features of the mixtures: y = (x − centre) · matrix.

    Without principal components the matrix only divides by the standard deviations, and mixtures
    are kept in the features' own units.

    Attributes
    ----------
    logged
        Names of the features used, as logged.
    dropped
        Features left out because they have the same value at every step of all trials.
    names
        Names of the features of the mixtures: ``logged``, or ``"component 1"`` and so on.
    centre
        Mean of each used feature over all used samples of all variants, shape ``(feature,)``.
    matrix
        Shape ``(feature, mapped)``.
    scaling
        From standardised samples back to the units in which mixtures are reported.
    explained_variance
        Share of the variance that principal components keep; 1 without them.
    """

    logged: tuple[str, ...]
    dropped: tuple[str, ...]
    names: tuple[str, ...]
    centre: FloatArray
    matrix: FloatArray
    scaling: Scaling
    explained_variance: float

    @property
    def reduced(self) -> bool:
        """Whether principal components replaced the features."""
        return self.names != self.logged


@dataclass(frozen=True, kw_only=True, eq=False)
class VariantSamples:
    """The samples of all variants, scaled together (method: one scaling for an obstacle).

    Attributes
    ----------
    variants
        Distinct variants in ascending order, shape ``(variant, parameter)``.
    success_rate
        Mean success over the trials of all networks, shape ``(variant,)``.
    n_trials, n_recorded
        Trials and logged control steps of each variant, shape ``(variant,)``.
    stride
        Every how many control steps one was used, shape ``(variant,)``.
    samples
        Standardised samples of each variant in lexicographic order, ``(sample, mapped)`` each.
    trial
        Index of the trial that each of these samples came from, ``(sample,)`` each.
    network
        Network of each trial, shape ``(trial,)``.
    network_names
        Name of each network; empty where they have numbers only.
    features
        How the samples were made from the logged features.
    outliers
        Features of which one value is farther from the mean than all others together, with it.
    """

    variants: FloatArray
    success_rate: FloatArray
    n_trials: IntArray
    n_recorded: IntArray
    stride: IntArray
    samples: tuple[FloatArray, ...]
    trial: tuple[IntArray, ...]
    network: IntArray
    network_names: tuple[str, ...]
    features: FeatureMap
    outliers: Mapping[str, float]

    def network_name(self, network: int) -> str:
        """Return what a network is called."""
        return self.network_names[network] if self.network_names else str(network)


def variant_samples(trials: Trials, config: AnalysisConfig) -> VariantSamples:
    """Select, thin, standardise and, where asked for, reduce the features of trials.

    Raises
    ------
    InputError
        If a feature is unknown or not finite, no feature varies, there is only one variant, or a
        variant has too few samples.
    """
    variants, index = trials.variants()
    if variants.shape[0] < 2:
        raise InputError(
            f"The trials hold one variant only ({describe_variant(variants[0])}).",
            remedy="Record trials on at least two variants of the task: groups need a choice.",
        )
    if not np.isfinite(variants).all():
        raise InputError(
            "A variant is NaN or infinite.", remedy="Give each trial's task parameters as numbers."
        )
    n_variants = variants.shape[0]
    n_trials = np.bincount(index, minlength=n_variants)
    n_recorded = np.bincount(index, weights=trials.lengths, minlength=n_variants).astype(np.int64)
    success = np.bincount(index, weights=trials.success, minlength=n_variants) / n_trials
    stride = np.ones(n_variants, dtype=np.int64)
    if config.max_samples:
        stride = np.maximum(1, -(-n_recorded // config.max_samples)).astype(np.int64)
    kept = _thinned(trials, stride[index])
    names, x = _selected(trials, config, kept)
    trial_of = np.repeat(np.arange(trials.n_trials), trials.lengths)[kept]
    feature_map = _feature_map(names, x, config)
    dropped = set(feature_map.dropped)
    used = [index for index, name in enumerate(names) if name not in dropped]
    z = (x[:, used] - feature_map.centre) @ feature_map.matrix
    samples: list[FloatArray] = []
    origins: list[IntArray] = []
    for variant in range(n_variants):
        rows = index[trial_of] == variant
        own = z[rows]
        if own.shape[0] < config.min_samples_per_component:
            raise InputError(
                f"Variant {describe_variant(variants[variant])} has {own.shape[0]} samples, fewer "
                f"than the {config.min_samples_per_component} that one component needs.",
                remedy="Record more trials on it, drop the variant, or lower "
                "`min_samples_per_component`.",
            )
        order = np.lexsort(own.T[::-1])
        samples.append(np.ascontiguousarray(own[order]))
        origins.append(trial_of[rows][order])
    return VariantSamples(
        variants=variants,
        success_rate=success,
        n_trials=n_trials.astype(np.int64),
        n_recorded=n_recorded,
        stride=stride,
        samples=tuple(samples),
        trial=tuple(origins),
        network=trials.network,
        network_names=trials.network_names,
        features=feature_map,
        outliers=_outliers(names, x),
    )


def describe_variant(variant: FloatArray | Sequence[float]) -> str:
    """Return a variant as people write it: ``180`` or ``(180, 0.7)``."""
    parts = [f"{value:g}" for value in np.atleast_1d(np.asarray(variant))]
    return parts[0] if len(parts) == 1 else f"({', '.join(parts)})"


def _thinned(trials: Trials, stride: IntArray) -> BoolArray:
    """Return which steps are kept: in each trial every ``stride``-th, from its middle on."""
    lengths = trials.lengths
    position = np.arange(trials.n_samples) - np.repeat(trials.starts[:-1], lengths)
    first = np.minimum(stride // 2, lengths - 1)
    return position % np.repeat(stride, lengths) == np.repeat(first, lengths)


def _selected(
    trials: Trials, config: AnalysisConfig, kept: BoolArray
) -> tuple[tuple[str, ...], FloatArray]:
    names = config.features or trials.feature_names
    place = {name: index for index, name in enumerate(trials.feature_names)}
    columns = (
        trials.features[:, place[name]] if name in place else trials.column(name)  # refused there
        for name in names
    )
    x = np.stack([column[kept] for column in columns], axis=1).astype(np.float64)
    finite = np.asarray((np.abs(x) <= _LARGEST_VALUE).all(axis=0))
    if not finite.all():
        bad = [name for name, good in zip(names, finite, strict=True) if not good]
        raise InputError(
            f"Features hold NaN or infinite values: {', '.join(bad)}.",
            remedy="Clip what is infinite, drop trials in which a value is missing, or leave the "
            "features out with `features`.",
        )
    return names, x


def _feature_map(names: tuple[str, ...], x: FloatArray, config: AnalysisConfig) -> FeatureMap:
    scaling = scaling_of(x)
    varies = np.asarray(scaling.scale > 0)
    logged = tuple(name for name, moves in zip(names, varies, strict=True) if moves)
    dropped = tuple(name for name, moves in zip(names, varies, strict=True) if not moves)
    if not logged:
        raise InputError(
            f"No feature varies: {', '.join(names)} have one value each in all trials.",
            remedy="Log features of the behaviour that change, such as position or time.",
        )
    centre, scale = scaling.centre[varies], scaling.scale[varies]
    reduce = config.reduction == "pca" or (
        config.reduction == "auto" and len(logged) > config.max_features
    )
    if not reduce:
        return FeatureMap(
            logged=logged,
            dropped=dropped,
            names=logged,
            centre=centre,
            matrix=np.diag(1.0 / scale),
            scaling=Scaling(centre=centre, scale=scale),
            explained_variance=1.0,
        )
    variance, axes = _principal_axes((x[:, varies] - centre) / scale)
    share = np.cumsum(variance) / variance.sum()
    n_axes = min(int(np.searchsorted(share, config.explained_variance - 1e-12)) + 1, share.size)
    return FeatureMap(
        logged=logged,
        dropped=dropped,
        names=tuple(f"component {number}" for number in range(1, n_axes + 1)),
        centre=centre,
        matrix=axes[:, :n_axes] / scale[:, None],
        scaling=Scaling(centre=np.zeros(n_axes), scale=np.ones(n_axes)),
        explained_variance=float(share[n_axes - 1]),
    )


def _outliers(names: Sequence[str], x: FloatArray) -> dict[str, float]:
    """Return the single values that make up more than half of their feature's variance.

    Divided by such a standard deviation, everything else hardly differs.
    """
    if x.shape[0] < _FEWEST_FOR_OUTLIERS:
        return {}
    found: dict[str, float] = {}
    for name, column in zip(names, x.T, strict=True):
        squares = np.square(column - column.mean())
        row = int(squares.argmax())
        rest = np.delete(column, row)
        if squares[row] > _OUTLYING * np.square(rest - rest.mean()).sum():
            found[name] = float(column[row])
    return found


def _principal_axes(z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return variances, largest first, and axes as columns, each with a fixed sign."""
    variance, axes = np.linalg.eigh(z.T @ z / z.shape[0])
    variance, axes = np.maximum(variance[::-1], 0.0), axes[:, ::-1]
    largest = np.abs(axes).argmax(axis=0)
    return variance, axes * np.sign(axes[largest, np.arange(axes.shape[1])])
