"""Features that may decide a grouping and be no behaviour: clocks, counters, the task itself."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surmount.analysis.agreement import adjusted_rand
from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.features import variant_samples
from surmount.analysis.hellinger import hellinger_matrix
from surmount.analysis.mixture import Mixture
from surmount.analysis.sensitivity import group_variants, marginal, refits
from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.trials.trials import Trials

SuspectKind = Literal["clock", "network-clock", "task"]
_FEWEST_TRIALS = 8
"""Of fewer, ranges that do not overlap may be chance."""
_CONSTANT = 1e-9
"""Range within a variant, as a share of the whole, below which there is one value."""


@dataclass(frozen=True, kw_only=True)
class Suspect:
    """A feature that may not be behaviour.

    Attributes
    ----------
    feature
        Its name.
    kind
        ``"clock"``: it rises over the whole table from trial to trial; ``"network-clock"``: over
        the trials of each network; ``"task"``: it has a single value on each variant.
    n_groups
        Groups without all such features.
    agreement
        Adjusted Rand index of these groups with the analysis's own.
    """

    feature: str
    kind: SuspectKind
    n_groups: int
    agreement: float


def find_suspects(
    trials: Trials,
    names: Sequence[str],
    mixtures: Sequence[Mixture],
    labels: IntArray,
    config: AnalysisConfig,
    *,
    reduced: bool,
    seed: int,
) -> tuple[Suspect, ...]:
    """Find features that may not be behaviour, and how the grouping is without them.

    Parameters
    ----------
    trials
        The trials of the analysis.
    names
        Features that it used, as logged.
    mixtures, labels
        Its mixtures and groups.
    config
        Its configuration.
    reduced
        Whether its mixtures are over principal components: then leaving features out takes new
        fits.
    seed
        Seed of its fits.
    """
    kinds: dict[str, SuspectKind] = {}
    _, variant = trials.variants()
    for name in names:
        values = trials.column(name)
        low, high = _ranges(trials, values)
        kind = _clock(trials, values, low, high)
        if kind or _is_task(variant, low, high):
            kinds[name] = kind or "task"
    if not kinds:
        return ()
    found = _groups_without(trials, names, list(kinds), mixtures, config, reduced, seed)
    n_groups, agreement = int(found.max()) + 1, adjusted_rand(found, labels)
    return tuple(
        Suspect(feature=name, kind=kind, n_groups=n_groups, agreement=agreement)
        for name, kind in kinds.items()
    )


def _groups_without(
    trials: Trials,
    names: Sequence[str],
    left_out: Sequence[str],
    mixtures: Sequence[Mixture],
    config: AnalysisConfig,
    reduced: bool,
    seed: int,
) -> IntArray:
    kept = [index for index, name in enumerate(names) if name not in left_out]
    if not kept:
        return np.zeros(len(mixtures), dtype=np.int64)
    if not reduced:
        partial = [marginal(mixture, kept) for mixture in mixtures]
        return group_variants(hellinger_matrix(partial), config)
    without = dataclasses.replace(config, features=tuple(names[index] for index in kept))
    data = variant_samples(trials, without)
    count = max(mixture.n_components for mixture in mixtures)
    return group_variants(
        hellinger_matrix(refits(data.samples, data, count, without, seed)), config
    )


def _ranges(trials: Trials, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the smallest and the largest value of each trial, shape ``(trial,)`` each."""
    begin = trials.starts[:-1]
    return np.minimum.reduceat(values, begin), np.maximum.reduceat(values, begin)


def _clock(
    trials: Trials, values: FloatArray, low: FloatArray, high: FloatArray
) -> SuspectKind | None:
    """Return which clock a feature is: of the whole table, of each network, or ``None``."""
    step = np.diff(values, append=values[-1])
    step[trials.starts[1:] - 1] = 0.0
    least, most = _ranges(trials, step)

    def rises(one: BoolArray) -> bool:
        return bool((least[one] >= 0).all()) and _are_apart(
            low[one], high[one], moving=bool((most[one] > 0).any())
        )

    if trials.n_trials >= _FEWEST_TRIALS and rises(np.ones(trials.n_trials, dtype=np.bool_)):
        return "clock"
    networks = [trials.network == network for network in np.unique(trials.network)]
    long = [one for one in networks if one.sum() >= _FEWEST_TRIALS]
    return "network-clock" if long and all(map(rises, long)) else None


def _are_apart(low: FloatArray, high: FloatArray, *, moving: bool) -> bool:
    """Whether each trial has a range of its own.

    A value that stands still within trials is a counter where it is a whole number.
    """
    order = np.argsort(low, kind="stable")
    if (high[order][:-1] > low[order][1:]).any() or np.unique(low).size < low.size:
        return False
    return moving or bool((low == np.floor(low)).all())


def _is_task(variant: IntArray, low: FloatArray, high: FloatArray) -> bool:
    n_variants = int(variant.max()) + 1
    least, most = np.full(n_variants, np.inf), np.full(n_variants, -np.inf)
    np.minimum.at(least, variant, low)
    np.maximum.at(most, variant, high)
    whole = float(most.max() - least.min())
    single: BoolArray = (most - least) <= _CONSTANT * whole
    return whole > 0 and bool(single.all())
