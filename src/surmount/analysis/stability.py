"""How sure the grouping is: the same analysis on trials drawn again (bootstrap)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.expectation_maximisation import Components, expand, maximise_likelihood
from surmount.analysis.features import VariantSamples
from surmount.analysis.hellinger import hellinger_matrix
from surmount.analysis.mixture import Mixture
from surmount.analysis.progress import Progress, counter, silent
from surmount.analysis.sensitivity import group_variants
from surmount.analysis.threads import spread
from surmount.core.arrays import FloatArray, IntArray
from surmount.core.seeds import generator
from surmount.trials.trials import Trials

_REFIT_ITERATIONS = 5


@dataclass(frozen=True, kw_only=True, eq=False)
class Stability:
    """What became of the grouping when networks and trials were drawn again.

    Attributes
    ----------
    replicates
        How many times they were drawn.
    co_membership
        Share of replicates in which two variants are in one group, shape ``(variant, variant)``.
    group_counts
        Numbers of groups that occurred, each with its share of replicates, most frequent first.
    same_count
        Share of replicates with as many groups as the analysis itself.
    boundaries
        For each variant but the last, the share of replicates in which the next variant in
        ascending order is in another group, shape ``(variant - 1,)``.
    agreement
        Mean share of pairs of variants on which a replicate and the analysis agree whether they
        belong together (Rand index).
    """

    replicates: int
    co_membership: FloatArray
    group_counts: tuple[tuple[int, float], ...]
    same_count: float
    boundaries: FloatArray
    agreement: float

    def together(self, labels: IntArray) -> FloatArray:
        """Return how often two variants of a group stayed together, the mean over its pairs.

        Parameters
        ----------
        labels
            Group of each variant, shape ``(variant,)``.

        Returns
        -------
        FloatArray
            Shape ``(group,)``; 1 for a group of one variant.
        """
        return np.asarray(
            [_mean(self.co_membership[own][:, own]) for own in _members(labels)], dtype=np.float64
        )

    def apart(self, labels: IntArray) -> FloatArray:
        """Return how often variants of a group stayed apart from those of its nearest other group.

        Parameters
        ----------
        labels
            Group of each variant, shape ``(variant,)``.

        Returns
        -------
        FloatArray
            Shape ``(group,)``: 1 minus the largest mean co-membership with another group.
        """
        groups = _members(labels)
        mixed = [
            max((self._shared(own, other) for other in groups if other is not own), default=0.0)
            for own in groups
        ]
        return 1.0 - np.asarray(mixed, dtype=np.float64)

    def _shared(self, first: IntArray, second: IntArray) -> float:
        return float(self.co_membership[np.ix_(first, second)].mean())


def assess_stability(
    trials: Trials,
    data: VariantSamples,
    fits: tuple[Components, ...],
    labels: IntArray,
    config: AnalysisConfig,
    progress: Progress = silent,
) -> Stability:
    """Repeat the grouping on networks and trials drawn with replacement.

    Each replicate draws networks, and for every variant as many trials as it has of them, refits
    each mixture from where the analysis ended (at most five iterations, on at most
    ``bootstrap_samples`` control steps per variant), and groups as the analysis did. Starting
    from the analysis's own fits leaves out the chance of the starts. With a single network only
    trials are drawn, and nothing is said about another training run.

    The bootstrap errs on the cautious side: drawing again adds the noise of the trials a second
    time, which makes gaps within groups about √2 wider and leaves gaps between groups as they
    are, so a boundary that only just divides here often fails to divide in a replicate.

    Parameters
    ----------
    trials
        The trials of the analysis.
    data
        Its samples.
    fits
        Its mixtures over standardised features, one per variant.
    labels
        Its groups, shape ``(variant,)``.
    config
        Its configuration.
    progress
        Told after each replicate.
    """
    n_variants = data.variants.shape[0]
    prepared = [_thin(data, fits, variant, config) for variant in range(n_variants)]

    advance = counter(progress, "bootstrap", config.bootstrap)

    def grouped(replicate: int) -> IntArray:
        weights = resampled(trials, generator(config.seed, "bootstrap", replicate))
        mixtures = [
            _refit(phi, start, weights[origin].astype(np.float64), config)
            for phi, start, origin in prepared
        ]
        groups = group_variants(hellinger_matrix(mixtures), config)
        advance()
        return groups

    together = np.zeros((n_variants, n_variants))
    counts: dict[int, int] = {}
    agreement = 0.0
    same = labels[:, None] == labels
    pairs = np.triu_indices(n_variants, 1)
    for groups in spread(grouped, range(config.bootstrap)):
        co_members = groups[:, None] == groups
        together += co_members
        agreement += float((co_members[pairs] == same[pairs]).mean())
        n_groups = int(groups.max()) + 1
        counts[n_groups] = counts.get(n_groups, 0) + 1
    together /= config.bootstrap
    shares = sorted(
        ((count, times / config.bootstrap) for count, times in counts.items()),
        key=lambda entry: (-entry[1], entry[0]),
    )
    neighbours = np.arange(n_variants - 1)
    return Stability(
        replicates=config.bootstrap,
        co_membership=together,
        group_counts=tuple(shares),
        same_count=counts.get(int(labels.max()) + 1, 0) / config.bootstrap,
        boundaries=1.0 - together[neighbours, neighbours + 1],
        agreement=agreement / config.bootstrap,
    )


def resampled(trials: Trials, rng: np.random.Generator) -> IntArray:
    """Return how often each trial was drawn: networks first, then trials within variants."""
    _, variant = trials.variants()
    networks, network = np.unique(trials.network, return_inverse=True)
    drawn = rng.integers(networks.size, size=networks.size)
    times = np.bincount(drawn, minlength=networks.size)
    counts = np.zeros(trials.n_trials, dtype=np.int64)
    for index in range(int(variant.max()) + 1):
        own = variant == index
        # A variant that was never tried by the networks drawn keeps all its networks.
        draws = times if (times[network[own]] > 0).any() else np.ones_like(times)
        for chosen in np.flatnonzero(draws):
            cell = np.flatnonzero(own & (network == chosen))
            if cell.size:
                picks = rng.integers(cell.size, size=cell.size * int(draws[chosen]))
                counts[cell] += np.bincount(picks, minlength=cell.size)
    return counts


def _members(labels: IntArray) -> list[IntArray]:
    return [np.flatnonzero(labels == label) for label in np.unique(labels)]


def _mean(square: FloatArray) -> float:
    pairs = square[np.triu_indices(square.shape[0], 1)]
    return float(pairs.mean()) if pairs.size else 1.0


def _thin(
    data: VariantSamples, fits: tuple[Components, ...], variant: int, config: AnalysisConfig
) -> tuple[FloatArray, Components, IntArray]:
    samples, origin = data.samples[variant], data.trial[variant]
    step = max(1, -(-samples.shape[0] // config.bootstrap_samples))
    rows = slice(step // 2, None, step)
    return expand(samples[rows]), fits[variant], origin[rows]


def _refit(
    phi: FloatArray, start: Components, weights: FloatArray, config: AnalysisConfig
) -> Mixture:
    used = weights > 0
    if not used.any():
        return Mixture(weights=start.weights, means=start.means, covariances=start.covariances)
    fit = maximise_likelihood(
        phi[used],
        start,
        regularisation=config.regularisation,
        tolerance=config.tolerance,
        max_iterations=_REFIT_ITERATIONS,
        sample_weights=weights[used],
    )
    parts = fit.components
    return Mixture(weights=parts.weights, means=parts.means, covariances=parts.covariances)
