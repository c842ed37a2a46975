"""Group × method with a random intercept per network: the linear mixed model of paper III-E."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np

from surmount.core.errors import InputError
from surmount.stats.columns import Table, require_confidence
from surmount.stats.mixed.cells import CellMean, Cells, Interaction, MethodContrast
from surmount.stats.mixed.design import read_design
from surmount.stats.mixed.inference import DegreesOfFreedom, means_law
from surmount.stats.mixed.random_intercept import RandomInterceptFit, decompose, fit, undefined
from surmount.stats.result import Result

SINGULAR_RATIO = 1e-8
"""lme4 calls a fit singular when τ/σ² is below this (its tolerance 1e-4 is on the root)."""


@dataclass(frozen=True, kw_only=True)
class MixedModel(Result):
    """Linear mixed model ``response ~ group * method + (1 | subject)``, fitted by REML.

    Attributes
    ----------
    response
        Name of the response.
    groups, methods, subjects
        Labels, in the order used.
    n_rows
        Rows fitted.
    degrees_of_freedom_rule
        ``"kenward-roger"`` or ``"satterthwaite"``.
    confidence
        Confidence level of all intervals.
    subject_variance, residual_variance
        Variances between and within subjects, in squared units of the response.
    reml_criterion
        Minus twice the restricted log-likelihood, as lme4 prints it.
    singular
        Whether the variance between subjects is estimated as zero; ``None`` if not estimated.
    singular_note
        What that means for the result, if it is so.
    means
        One per group and method, groups outermost.
    contrasts
        One per group and pair of methods, the earlier method minus the later.
    interaction
        Whether the difference between methods depends on the group.
    reason
        Why the variances and with them all tests are undefined, if they are.
    """

    response: str
    groups: tuple[str, ...]
    methods: tuple[str, ...]
    subjects: tuple[str, ...]
    n_rows: int
    degrees_of_freedom_rule: DegreesOfFreedom
    confidence: float
    subject_variance: float | None
    residual_variance: float | None
    reml_criterion: float | None
    singular: bool | None
    singular_note: str | None
    means: tuple[CellMean, ...]
    contrasts: tuple[MethodContrast, ...]
    interaction: Interaction
    reason: str | None


def mixed_model(
    table: Table,
    *,
    response: str,
    group: str,
    method: str,
    subject: str,
    groups: Sequence[object] | None = None,
    methods: Sequence[object] | None = None,
    degrees_of_freedom: DegreesOfFreedom = "kenward-roger",
    confidence: float = 0.95,
) -> MixedModel:
    """Compare methods within groups when trials of one network resemble each other.

    Equal to R's ``lme4::lmer(response ~ group * method + (1 | subject))`` with
    ``emmeans(pairwise ~ method | group, adjust = "none")``. Numbers that the data cannot give are
    ``None`` with a reason: empty cells, a single method, fewer than two networks.

    Parameters
    ----------
    table
        Columns by name, one row per trial: a mapping of arrays or sequences, or a data frame.
    response
        Name of the column to explain, for example a path length in degrees. Finite numbers: where
        a measure exists for successful trials only, leave the others out.
    group, method, subject
        Names of the columns with each row's group of variants, arm, and initial network.
    groups, methods
        Their labels in the order wanted, those without a row included; sorted by default.
        Contrasts are the earlier method minus the later.
    degrees_of_freedom
        Correction for estimated variances: ``"kenward-roger"``, emmeans' default for lmer, or
        ``"satterthwaite"``, lmerTest's.
    confidence
        Confidence level of the intervals.

    Returns
    -------
    MixedModel
        Variances, cell means, contrasts within groups, and the interaction.
    """
    require_confidence(confidence)
    if degrees_of_freedom not in get_args(DegreesOfFreedom):
        raise InputError(
            f"There is no rule `{degrees_of_freedom}` for degrees of freedom.",
            remedy=f"Choose among {', '.join(get_args(DegreesOfFreedom))}.",
        )
    design = read_design(
        table,
        response=response,
        group=group,
        method=method,
        subject=subject,
        groups=groups,
        methods=methods,
    )
    grouped, treated, network = design.group, design.method, design.subject
    n_methods = len(treated.names)
    cell = grouped.codes * n_methods + treated.codes  # index into all cells, empty ones included
    present, compact = np.unique(cell, return_inverse=True)
    data = decompose(design.response, compact.astype(np.int64), network.codes)
    reason = undefined(data)
    fitted = fit(data) if reason is None else None
    law = fitted and means_law(fitted, degrees_of_freedom)
    cells = Cells(
        groups=grouped.names,
        methods=treated.names,
        present=present,
        counts=data.cell_counts,
        arithmetic_means=data.cell_means,
        law=law,
        confidence=confidence,
        reason=reason,
    )
    singular = None if fitted is None else fitted.ratio < SINGULAR_RATIO
    return MixedModel(
        response=response,
        groups=grouped.names,
        methods=treated.names,
        subjects=network.names,
        n_rows=int(design.response.size),
        degrees_of_freedom_rule=degrees_of_freedom,
        confidence=confidence,
        subject_variance=fitted and fitted.subject_variance,
        residual_variance=fitted and fitted.residual_variance,
        reml_criterion=fitted and fitted.criterion,
        singular=singular,
        singular_note=_singular_note(fitted) if fitted and singular else None,
        means=cells.means(),
        contrasts=cells.contrasts(),
        interaction=cells.interaction(),
        reason=reason,
    )


def _singular_note(fitted: RandomInterceptFit) -> str:
    return (
        "The variance between networks is estimated as zero, the boundary of what it can be: "
        f"the {fitted.data.eigenvalues.size} networks differ no more than their trials would by "
        "chance. The contrasts are then those of ordinary least squares, and with few networks "
        "this does not show that networks are alike."
    )
