"""Fitting a mixture to samples: scaling, restarts, and a result in the features' own units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.analysis.component_count import BICCurve, choose_components
from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.expectation_maximisation import (
    Components,
    Fit,
    expand,
    maximise_likelihood,
)
from surmount.analysis.initialisation import start_components
from surmount.analysis.mixture import FitReport, Mixture, bic
from surmount.analysis.threads import spread
from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.core.seeds import generator

_TRIAL_SAMPLES = 4096
"""Samples on which starts are compared before the best one goes on with all samples."""
_TRIAL_ITERATIONS = 10
_FLOOR_FACTOR = 4.0
"""A component counts as floored when its smallest variance is below this × the regularisation."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scaling:
    """One affine scaling shared by all variants: z = (x − centre) / scale.

    Attributes
    ----------
    centre, scale
        Mean and standard deviation of each feature, shape ``(feature,)``; scales are positive.
    """

    centre: FloatArray
    scale: FloatArray

    def apply(self, x: FloatArray) -> FloatArray:
        """Return standardised samples."""
        return (x - self.centre) / self.scale

    def undo(self, components: Components) -> Components:
        """Return components over features in their own units."""
        return Components(
            weights=components.weights,
            means=components.means * self.scale + self.centre,
            covariances=components.covariances * self.scale[:, None] * self.scale,
        )

    def redo(self, mixture: Mixture) -> Components:
        """Return a mixture's components over standardised features."""
        return Components(
            weights=mixture.weights,
            means=(mixture.means - self.centre) / self.scale,
            covariances=mixture.covariances / (self.scale[:, None] * self.scale),
        )


def fit_mixture(
    samples: FloatArray,
    n_components: int | None = None,
    *,
    seed: int,
    config: AnalysisConfig | None = None,
) -> Mixture:
    """Fit a mixture of Gaussians with full covariances (paper eq. 2).

    Samples are standardised, several k-means++ starts are compared, and the best one goes on to
    convergence. The order of the samples does not matter.

    Parameters
    ----------
    samples
        Shape ``(sample, feature)``, in any units.
    n_components
        Number of components K; ``None`` chooses it by the BIC over the configured range (eq. 3).
    seed
        Seed of the starts; the result is a function of it and the samples.
    config
        Restarts, regularisation, tolerance and the range of K; defaults where absent.

    Returns
    -------
    Mixture
        In the samples' units, with the report of its fit. It has fewer components than asked for
        where components collapsed or there are fewer distinct samples.

    Raises
    ------
    InputError
        If samples are not a finite table of at least two rows, a feature does not vary, or the
        number of components is not positive or exceeds the number of samples.
    """
    settings = config or AnalysisConfig()
    x = np.asarray(samples, dtype=np.float64)
    if x.ndim != 2 or x.shape[0] < 2 or x.shape[1] < 1:
        raise InputError(
            f"A mixture needs samples of shape (sample, feature), not {x.shape}.",
            remedy="Give at least two rows, one per sample, and one column per feature.",
        )
    if not np.isfinite(x).all():
        raise InputError("Samples hold NaN or infinite values.", remedy="Drop those rows.")
    if n_components is not None and not 1 <= n_components <= x.shape[0]:
        raise InputError(
            f"{n_components} components cannot be fitted to {x.shape[0]} samples.",
            remedy=f"Ask for 1 to {x.shape[0]} components.",
        )
    scaling = scaling_of(x)
    constant = np.flatnonzero(scaling.scale == 0.0)
    if constant.size:
        raise InputError(
            f"Feature column {int(constant[0])} has the same value in all samples.",
            remedy="Drop constant features before fitting.",
        )
    scaled = FitSamples(canonical_order(scaling.apply(x)))
    if n_components is None:
        n_components = bic_curve(scaled, settings, seed).chosen
    return mixture_of(scaled.fit(n_components, settings, seed), scaling, settings, n_components)


def scaling_of(x: FloatArray) -> Scaling:
    """Return mean and standard deviation of each feature; the scale is 0 where it is constant."""
    centre = x.mean(axis=0)
    scale = x.std(axis=0)
    # Rounding leaves a constant feature a spread of some 1e-16 of its size.
    scale[np.ptp(x, axis=0) <= 1e-12 * np.abs(x).max(axis=0)] = 0.0
    return Scaling(centre=centre, scale=scale)


def canonical_order(x: FloatArray) -> FloatArray:
    """Return the samples in lexicographic order, so that nothing depends on the order given."""
    return np.ascontiguousarray(x[np.lexsort(x.T[::-1])])


class FitSamples:
    """Standardised samples with their expanded features, ready for any number of fits."""

    def __init__(self, z: FloatArray) -> None:
        self.z = z
        self.phi = expand(z)
        step = max(1, z.shape[0] // _TRIAL_SAMPLES)
        # Samples are in lexicographic order, so even steps give a stratified subset.
        self._subset = z[step // 2 :: step]
        self._subset_phi = self.phi[step // 2 :: step]

    @property
    def n_samples(self) -> int:
        """Number of samples."""
        return int(self.z.shape[0])

    def fit(self, n_components: int, config: AnalysisConfig, seed: int) -> Fit:
        """Fit from the best of several starts."""
        best: Fit | None = None
        for restart in range(config.restarts):
            rng = generator(seed, "start", n_components, restart)
            start = start_components(self._subset, n_components, config.regularisation, rng)
            trial = maximise_likelihood(
                self._subset_phi,
                start,
                regularisation=config.regularisation,
                tolerance=config.tolerance,
                max_iterations=_TRIAL_ITERATIONS,
            )
            if best is None or trial.log_likelihood > best.log_likelihood:
                best = trial
        assert best is not None  # noqa: S101 - the configuration asks for at least one start
        final = maximise_likelihood(
            self.phi,
            best.components,
            regularisation=config.regularisation,
            tolerance=config.tolerance,
            max_iterations=config.max_iterations,
        )
        return Fit(
            components=final.components,
            log_likelihood=final.log_likelihood,
            n_samples=final.n_samples,
            iterations=final.iterations,
            converged=final.converged,
            collapsed=n_components - final.components.weights.size,
        )


def bic_curve(samples: FitSamples, config: AnalysisConfig, seed: int) -> BICCurve:
    """Fit every K of the configured range and choose one by the BIC (eq. 3)."""
    most = affordable_components(samples.n_samples, config)
    counts = list(range(min(config.min_components, most), min(config.max_components, most) + 1))
    fits = spread(lambda count: samples.fit(count, config, seed), counts)
    values = [
        bic(fit.log_likelihood, samples.n_samples, *fit.components.means.shape) for fit in fits
    ]
    converged = [fit.converged for fit in fits]
    return choose_components(counts, values, converged, config.plateau)


def affordable_components(n_samples: int, config: AnalysisConfig) -> int:
    """Return the largest K that leaves each component enough samples on average."""
    return max(1, n_samples // config.min_samples_per_component)


def mixture_of(fit: Fit, scaling: Scaling, config: AnalysisConfig, requested: int) -> Mixture:
    """Return the record of a fit, in the features' own units."""
    components = scaling.undo(fit.components)
    smallest = np.linalg.eigvalsh(fit.components.covariances)[:, 0]
    return Mixture(
        weights=components.weights,
        means=components.means,
        covariances=components.covariances,
        fit=FitReport(
            n_samples=fit.n_samples,
            # dx = scale dz: densities per unit of x are lower by the product of the scales.
            log_likelihood=fit.log_likelihood - fit.n_samples * float(np.log(scaling.scale).sum()),
            converged=fit.converged,
            iterations=fit.iterations,
            restarts=config.restarts,
            requested=requested,
            collapsed=fit.collapsed,
            floored=int((smallest < _FLOOR_FACTOR * config.regularisation).sum()),
        ),
    )
