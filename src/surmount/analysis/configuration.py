"""Configuration of the analysis: every choice the paper prints and every one it leaves open."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from surmount.core.configuration import absent
from surmount.core.errors import ConfigError

LinkageMethod = Literal["average", "complete", "single", "weighted", "ward"]
CutMethod = Literal["abrupt", "inconsistency", "largest gap", "silhouette", "fixed count"]
BoundsRule = Literal["halfway", "range"]
Reduction = Literal["auto", "none", "pca"]


@dataclass(frozen=True, kw_only=True)
class AnalysisConfig:
    """Choices of the analysis, from features to levels.

    Attributes
    ----------
    seed
        Seed of everything random in the analysis: starts of the fits, bootstrap, scatter samples.
        In an experiment the root seed goes into it, too; the result says what came of both.
    features
        Features to use, by name; none named means all that the trials hold (the paper uses time,
        sprawl, FBEM and distance to the target, II-B).
    reduction
        Principal components instead of features: ``"auto"`` only where more than
        ``max_features`` features remain, ``"pca"`` always, ``"none"`` never. Assumed.
    max_features
        Features above which ``"auto"`` reduces. Assumed.
    explained_variance
        Share of the variance of standardised features that kept principal components explain.
        Assumed.
    max_samples
        Control steps used per variant; trials are thinned evenly down to it, because
        neighbouring steps say nearly the same. 0 uses every step. Assumed.
    min_samples_per_component
        Samples that a component needs on average: a variant with few samples gets fewer
        components. Assumed.
    min_components, max_components
        Range of K over which the BIC is computed (paper III-C: 2 to 20).
    components
        Fixed K; 0 chooses it by the BIC. The paper found 16 on its highest step and used it for
        all obstacles; here each task's trials choose their own unless it is given.
    components_per_variant
        Whether each variant gets its own K by the BIC instead of one K for all (paper: one).
    bic_variant
        Variant on which K is chosen, one value per task parameter; none named means the hardest:
        by ``harder`` where that is known, as the paper's highest step, else the variant with the
        lowest success.
    harder
        For each task parameter 1 where larger values are harder, −1 where smaller ones are; none
        where nobody knows. A run fills it in from its task. It decides nothing but the variant on
        which K is chosen: groups are ranked by success.
    plateau
        The smallest K is taken whose BIC lies within this share of the curve's whole fall above
        its minimum; 0 takes the minimum itself, as the paper does. On long recordings the curve
        may fall to the end of the range; 0.01 then takes a smaller K that fits nearly as well.
    restarts
        Starts by k-means++ of which the best goes on. Assumed.
    regularisation
        Variance added to the diagonal of each covariance, in units of each feature's variance over
        all variants. Assumed.
    tolerance
        Mean gain in log-likelihood per sample and iteration, in nats, below which a fit has
        converged. Assumed.
    max_iterations
        Iterations after which a fit ends without having converged. Assumed.
    check_distances
        Whether each distance is also computed by quasi-Monte Carlo with a standard error of D²
        below 1e-3, to see how good the unscented one is; takes some 0.05 s a pair.
    linkage
        Linkage of the agglomerative clustering. Assumed.
    cut
        Rule that cuts the dendrogram into groups; see ``docs/adr/0010-cut-rule.md``. Assumed.
    cut_off
        Threshold of the rule: how many times wider than the usual gap inside its tighter side a
        link's gap must be (``"abrupt"``, 1.5 by default) or the inconsistency coefficient
        (``"inconsistency"``, 2.4 by default); 0 takes the rule's default. Unused by the other
        rules. Assumed.
    alike_distance
        Hellinger distance up to which the rule ``"abrupt"`` takes behaviours for alike: usual gaps
        count as at least that. Assumed; see ``docs/adr/0011-networks-and-long-recordings.md``.
    inconsistency_depth
        Levels of links below each link that enter its inconsistency coefficient; 0 means all.
        Assumed.
    group_count
        Number of groups for the rule ``"fixed count"``, before small groups are merged.
    small_group_size
        Groups of at most this many variants are merged into their neighbour (paper III-C: two).
    small_group_fraction
        Groups of at most this share of all variants are merged as well; 0.1 is the wording of
        paper II-B, "an order of magnitude fewer than the number of variants", 0 leaves it out.
    success_threshold
        Groups with at least this success rate need no level (paper II-C: 95 %).
    dominant_weight
        Weight of a level's dominant group. Assumed: Table 2 of the paper is lost.
    harder_share
        Share of the remaining weight that goes to groups harder than the dominant one: a third, so
        that more goes to the easier ones, against forgetting. Assumed.
    bounds
        ``"halfway"`` extends a group half-way to the neighbouring variants of other groups,
        ``"range"`` ends it at its own outermost variants (paper II-C names both).
    bootstrap
        Bootstrap replicates over trials by which the grouping's stability is judged; 0 leaves the
        question open. Assumed.
    bootstrap_samples
        Control steps per variant in a bootstrap replicate. Assumed.
    stability_threshold
        Share of replicates below which the number of groups or a boundary is called not stable.
        Assumed.
    sensitivity
        Whether the grouping is repeated with each choice changed in turn.
    scatter_samples
        Recorded and sampled points kept in the result for the figure of the fit.
    """

    seed: int = 0
    features: tuple[str, ...] = ()
    reduction: Reduction = "auto"
    max_features: int = 8
    explained_variance: float = 0.99
    max_samples: int = 20_000
    min_samples_per_component: int = 20
    min_components: int = 2
    max_components: int = 20
    components: int = 0
    components_per_variant: bool = False
    bic_variant: tuple[float, ...] = ()
    harder: tuple[int, ...] = field(default=(), metadata=absent(()))
    plateau: float = 0.0
    restarts: int = 3
    regularisation: float = 1e-4
    tolerance: float = 1e-3
    max_iterations: int = 200
    check_distances: bool = False
    linkage: LinkageMethod = "average"
    cut: CutMethod = "abrupt"
    cut_off: float = 0.0
    alike_distance: float = 0.2
    inconsistency_depth: int = 0
    group_count: int = 3
    small_group_size: int = 2
    small_group_fraction: float = 0.0
    success_threshold: float = 0.95
    dominant_weight: float = 0.7
    harder_share: float = 1 / 3
    bounds: BoundsRule = "halfway"
    bootstrap: int = 30
    bootstrap_samples: int = 1_000
    stability_threshold: float = 0.8
    sensitivity: bool = True
    scatter_samples: int = 1_000

    def __post_init__(self) -> None:
        for name, low, high in _RANGES:
            value = getattr(self, name)
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not (number and math.isfinite(value) and low <= value <= high):
                raise ConfigError(
                    f"Analysis option `{name}` is {value!r}.",
                    remedy=f"Give a value from {low:g} to {high:g}.",
                )
        if self.min_components > self.max_components:
            raise ConfigError(
                f"Analysis option `min_components` ({self.min_components}) exceeds "
                f"`max_components` ({self.max_components}).",
                remedy="Swap the two.",
            )
        for name, choices in _CHOICES.items():
            if getattr(self, name) not in choices:
                raise ConfigError(
                    f"Analysis option `{name}` is {getattr(self, name)!r}.",
                    remedy=f"Choose among {', '.join(choices)}.",
                )
        if len(set(self.features)) < len(self.features):
            raise ConfigError(
                f"Analysis option `features` names a feature twice: {', '.join(self.features)}.",
                remedy="Name each feature once.",
            )
        if not all(math.isfinite(value) for value in self.bic_variant):
            raise ConfigError(
                "Analysis option `bic_variant` is not finite.", remedy="Name a recorded variant."
            )
        if any(sign not in (1, -1) for sign in self.harder):
            raise ConfigError(
                f"Analysis option `harder` is {list(self.harder)}.",
                remedy="Give 1 or -1 for each task parameter, or leave it out.",
            )


_UNLIMITED = 1e12
_RANGES: tuple[tuple[str, float, float], ...] = (
    ("seed", 0, 2**31 - 1),
    ("max_features", 1, 1000),
    ("explained_variance", 1e-6, 1.0),
    ("max_samples", 0, _UNLIMITED),
    ("min_samples_per_component", 2, _UNLIMITED),
    ("min_components", 1, 1000),
    ("max_components", 1, 1000),
    ("components", 0, 1000),
    ("plateau", 0.0, 1.0),
    ("restarts", 1, 1000),
    ("regularisation", 1e-12, 1.0),
    ("tolerance", 1e-12, 1.0),
    ("max_iterations", 1, 1_000_000),
    ("cut_off", 0.0, 1000.0),
    ("alike_distance", 0.0, 0.99),
    ("inconsistency_depth", 0, 1_000_000),
    ("group_count", 1, 1_000_000),
    ("small_group_size", 0, 1_000_000),
    ("small_group_fraction", 0.0, 1.0),
    ("success_threshold", 0.0, 1.0),
    ("dominant_weight", 1e-6, 1.0),
    ("harder_share", 0.0, 1.0),
    ("bootstrap", 0, 100_000),
    ("bootstrap_samples", 10, _UNLIMITED),
    ("stability_threshold", 0.0, 1.0),
    ("scatter_samples", 0, 1_000_000),
)
_CHOICES: dict[str, tuple[str, ...]] = {
    "reduction": ("auto", "none", "pca"),
    "linkage": ("average", "complete", "single", "weighted", "ward"),
    "cut": ("abrupt", "inconsistency", "largest gap", "silhouette", "fixed count"),
    "bounds": ("halfway", "range"),
}
