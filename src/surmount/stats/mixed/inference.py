r"""Tests of linear contrasts of cell means: Kenward–Roger's and Satterthwaite's corrections.

Both treat the variances τ (between subjects) and s = σ² (residual) as estimated. Let Φ(τ, s) be
the covariance of the cell means, ``∂ᵢΦ`` its derivatives in (τ, s), and ``W`` the asymptotic
covariance of the two estimates. For one contrast ``l`` with variance ``v = lᵀΦl`` and gradient
``gᵢ = lᵀ∂ᵢΦ l`` both take ``2v²/(gᵀWg)`` degrees of freedom; they differ in this:

* *Kenward–Roger* (Biometrics 53, 1997) takes ``W`` from the expected information and enlarges the
  standard error: ``Φ_A = Φ − Σᵢⱼ Wᵢⱼ ∂ᵢ∂ⱼΦ``. Because V is linear in (τ, s), this is their
  ``Φ + 2Φ{Σ Wᵢⱼ(Qᵢⱼ − PᵢΦPⱼ)}Φ`` word for word. It is what emmeans reports for an lmer fit.
* *Satterthwaite* takes ``W`` from the observed information and leaves the standard error alone,
  as lmerTest does. On the boundary τ = 0 the residual variance alone is estimated.

Φ depends on (τ, s) through ``s D⁻¹`` and ``cₖ = sτ/(s + λₖτ)`` only, so all derivatives are
closed forms.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.special import fdtrc, stdtr, stdtrit  # laws of F and t; scipy.stats is slow to import

from surmount.core.arrays import FloatArray
from surmount.stats.mixed.random_intercept import RandomInterceptFit

DegreesOfFreedom: TypeAlias = Literal["kenward-roger", "satterthwaite"]


@dataclass(frozen=True, kw_only=True, eq=False)
class MeansLaw:
    """What is known about the uncertainty of all cell means of a fit under one correction.

    Attributes
    ----------
    fit
        The fit.
    variance_covariance
        W/s², covariance of the estimates of τ and s, shape ``(2, 2)``.
    rule
        Which correction is used.
    """

    fit: RandomInterceptFit
    variance_covariance: FloatArray
    rule: DegreesOfFreedom


@dataclass(frozen=True, kw_only=True, eq=False)
class ContrastLaw:
    """Contrasts ``L`` of cell means with their uncertainty, in units of s = σ².

    Attributes
    ----------
    values
        Estimate of each contrast over √s, shape ``(contrast,)``.
    covariance
        LΦLᵀ/s for known variances, shape ``(contrast, contrast)``.
    reported
        Covariance behind standard errors, over s: LΦLᵀ, or LΦ_ALᵀ by Kenward and Roger.
    gradient
        L(∂Φ/∂τ)Lᵀ and L(∂Φ/∂s)Lᵀ, shape ``(2, contrast, contrast)``.
    variance_covariance, rule
        As in :class:`MeansLaw`.
    """

    values: FloatArray
    covariance: FloatArray
    reported: FloatArray
    gradient: FloatArray
    variance_covariance: FloatArray
    rule: DegreesOfFreedom


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One linear contrast of cell means: value, standard error, degrees of freedom, limits."""

    value: float
    std_error: float
    degrees_of_freedom: float
    lower: float
    upper: float
    t: float
    p_value: float


@dataclass(frozen=True, kw_only=True)
class JointTest:
    """F-test that several contrasts are all zero."""

    statistic: float
    numerator_df: int
    denominator_df: float
    p_value: float


def means_law(fit: RandomInterceptFit, rule: DegreesOfFreedom) -> MeansLaw:
    """Return what a correction says of the estimated variances of a fit."""
    if rule == "kenward-roger":
        uncertainty = _twice_inverse(_expected_information(fit))
    elif fit.ratio == 0:
        uncertainty = np.diag([0.0, 2.0 / fit.data.contrasts])
    else:
        uncertainty = _twice_inverse(_observed_information(fit))
    return MeansLaw(fit=fit, variance_covariance=uncertainty, rule=rule)


def contrast_law(law: MeansLaw, contrasts: FloatArray) -> ContrastLaw:
    """Return contrasts of cell means, shape ``(contrast, cell)``, with their uncertainty.

    The contrasts of the directions gₖ are taken before these are weighted, so that a variance
    between subjects however large cannot swamp contrasts that it does not touch.
    """
    data, ratio, uncertainty = law.fit.data, law.fit.ratio, law.variance_covariance
    inner = 1.0 + ratio * data.eigenvalues
    seen = contrasts @ data.directions.T  # (contrast, subject)

    def along(weights: FloatArray) -> FloatArray:
        return (seen * weights) @ seen.T

    per_cell = (contrasts / data.cell_counts) @ contrasts.T
    covariance = per_cell + along(ratio / inner)
    gradient = np.stack(
        [along(1.0 / inner**2), per_cell + along(data.eigenvalues * (ratio / inner) ** 2)]
    )
    reported = covariance
    if law.rule == "kenward-roger":
        # The second derivatives of cₖ in (τ, s) are −1, ρ and −ρ² times this, over s.
        bend = 2 * data.eigenvalues / inner**3
        reported = (
            covariance
            + uncertainty[0, 0] * along(bend)
            - 2 * uncertainty[0, 1] * along(bend * ratio)
            + uncertainty[1, 1] * along(bend * ratio**2)
        )
    return ContrastLaw(
        values=contrasts @ law.fit.means / np.sqrt(law.fit.residual_variance),
        covariance=covariance,
        reported=reported,
        gradient=gradient,
        variance_covariance=uncertainty,
        rule=law.rule,
    )


def _twice_inverse(matrix: FloatArray) -> FloatArray:
    return 2 * np.linalg.inv(matrix).astype(np.float64)


def _expected_information(fit: RandomInterceptFit) -> FloatArray:
    """Return twice the expected information on (τ, s), times s²: I_E of Kenward and Roger."""
    lam = fit.data.eigenvalues[fit.data.eigenvalues > 0]
    precision = 1.0 / (1.0 + fit.ratio * lam)
    cross = float((lam * precision**2).sum())
    return np.array(
        [
            [float((lam**2 * precision**2).sum()), cross],
            [cross, float((precision**2).sum()) + fit.data.residual_df],
        ]
    )


def _observed_information(fit: RandomInterceptFit) -> FloatArray:
    """Return the Hessian of minus twice the restricted log-likelihood in (τ, s), times s²."""
    seen = fit.data.eigenvalues > 0
    lam = fit.data.eigenvalues[seen]
    square = fit.data.scores[seen] ** 2 / fit.residual_variance
    inner = 1.0 + fit.ratio * lam
    curve = 2 * square / inner**3 - 1 / inner**2
    rest = 2 * fit.data.residual_sum / fit.residual_variance - fit.data.residual_df
    cross = float((lam * curve).sum())
    return np.array([[float((lam**2 * curve).sum()), cross], [cross, float(curve.sum()) + rest]])


def estimate(law: MeansLaw, contrast: FloatArray, confidence: float) -> Estimate:
    """Estimate one contrast ``l``, shape ``(cell,)``, and test that it is zero."""
    single = contrast_law(law, contrast[None, :])
    unit = float(np.sqrt(law.fit.residual_variance))
    value = float(contrast @ law.fit.means)
    std_error = unit * float(np.sqrt(single.reported[0, 0]))
    degrees = _single_degrees(single, np.ones(1))
    t = value / std_error
    width = float(stdtrit(degrees, (1 + confidence) / 2)) * std_error
    return Estimate(
        value=value,
        std_error=std_error,
        degrees_of_freedom=degrees,
        lower=value - width,
        upper=value + width,
        t=t,
        p_value=2 * float(stdtr(degrees, -abs(t))),
    )


def _single_degrees(law: ContrastLaw, axis: FloatArray) -> float:
    """Return the degrees of freedom of one combination of contrasts, ``axis (contrast,)``."""
    variance = float(axis @ law.covariance @ axis)
    slope = law.gradient @ axis @ axis
    return 2 * variance**2 / float(slope @ law.variance_covariance @ slope)


def joint_test(law: MeansLaw, contrasts: FloatArray) -> JointTest | None:
    """Test that independent contrasts, shape ``(contrast, cell)``, are all zero.

    Returns
    -------
    JointTest or None
        The F-test; ``None`` where the correction yields no positive degrees of freedom.
    """
    count = contrasts.shape[0]
    joint = contrast_law(law, contrasts)
    wald = float(joint.values @ np.linalg.solve(joint.reported, joint.values))
    scale = 1.0
    if count == 1:
        degrees = _single_degrees(joint, np.ones(1))
    elif law.rule == "satterthwaite":
        degrees = _pooled_degrees(joint)
    else:
        degrees, scale = _kenward_roger_degrees(joint)
    if not (np.isfinite(degrees) and degrees > 0 and scale > 0):
        return None
    statistic = scale * wald / count
    return JointTest(
        statistic=statistic,
        numerator_df=count,
        denominator_df=degrees,
        p_value=float(fdtrc(count, degrees, statistic)),
    )


def _pooled_degrees(law: ContrastLaw) -> float:
    """Pool Satterthwaite's degrees of freedom of uncorrelated contrasts, as lmerTest does.

    Each has its own tₙ; the F-law's mean is matched (Fai & Cornelius, J. Stat. Comput. Simul.
    54, 1996).
    """
    _, axes = np.linalg.eigh(law.covariance)
    single = np.array([_single_degrees(law, axis) for axis in axes.T])
    if np.ptp(single) < 1e-8:  # where lmerTest, too, takes them as equal
        return float(single.mean())
    if (single <= 2).any():
        return 2.0
    mean = float((single / (single - 2)).sum())
    return 2 * mean / (mean - single.size)


def _kenward_roger_degrees(law: ContrastLaw) -> tuple[float, float]:
    """Return Kenward and Roger's denominator degrees of freedom and scale of F.

    The names follow their article and pbkrtest (Halekoh & Højsgaard, J. Stat. Software 59, 2014).
    """
    q = law.values.size
    parts = [np.linalg.solve(law.covariance, gradient) for gradient in law.gradient]
    traces = np.array([np.trace(part) for part in parts])
    products = np.array([[float((a * b.T).sum()) for b in parts] for a in parts])
    a1 = float(traces @ law.variance_covariance @ traces)
    a2 = float((law.variance_covariance * products).sum())
    b = (a1 + 6 * a2) / (2 * q)
    g = ((q + 1) * a1 - (q + 4) * a2) / ((q + 2) * a2)
    c1, c2, c3 = np.array([g, q - g, q + 2 - g]) / (3 * q + 2 * (1 - g))
    mean_ratio = 1.0 if abs(1 - c2 * b) < 1e-10 else (1 - a2 / q) / (1 - c2 * b)
    with np.errstate(divide="ignore", invalid="ignore"):  # the caller looks for finite degrees
        rho = mean_ratio**2 * (1 + c1 * b) / (1 - c3 * b) / q
        degrees = float(4 + (q + 2) / (q * rho - 1))
    # F's scale has a pole at two degrees of freedom, where pbkrtest leaves F as it is.
    scale = 1.0 if abs(degrees - 2) < 0.01 else degrees * (1 - a2 / q) / (degrees - 2)
    return degrees, float(scale)
