"""The mixed model's contrasts network by network: how far they would hold for another network.

A random intercept makes trials of one network alike, but takes the difference between two arms as
the same in all networks, so that with thousands of trials its standard error says nothing of
networks yet to be trained (ADR 30). Beside each contrast belongs how the networks' own differences
spread.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.stats.columns import ROUNDING, Table
from surmount.stats.mixed.design import Design, read_design
from surmount.stats.result import Result


@dataclass(frozen=True, kw_only=True)
class NetworkContrast(Result):
    """Differences between two methods within one group, one per network.

    Attributes
    ----------
    group
        The group.
    method, reference
        Each difference is a network's mean with ``method`` minus its mean with ``reference``.
    networks
        Networks with rows of both methods in this group.
    differences
        Their differences, in units of the response.
    left_out
        Networks without rows of one or both methods in this group.
    mean, sd
        Mean and standard deviation of the differences, every network counting alike; ``None``
        where undefined. The mean differs from the mixed model's estimate where networks have
        unequal numbers of rows.
    lowest, highest
        Their range.
    same_sign
        Networks whose difference has the sign of the mean; none has that of a mean of 0.
    reason
        Why numbers are ``None``, if any is.
    """

    group: str
    method: str
    reference: str
    networks: tuple[str, ...]
    differences: tuple[float, ...]
    left_out: tuple[str, ...]
    mean: float | None
    sd: float | None
    lowest: float | None
    highest: float | None
    same_sign: int
    reason: str | None


def network_contrasts(
    table: Table,
    *,
    response: str,
    group: str,
    method: str,
    subject: str,
    groups: Sequence[object] | None = None,
    methods: Sequence[object] | None = None,
) -> tuple[NetworkContrast, ...]:
    """Return each contrast of the mixed model with its spread over networks.

    Parameters
    ----------
    table, response, group, method, subject, groups, methods
        As in :func:`surmount.stats.mixed_model`.

    Returns
    -------
    tuple of NetworkContrast
        One per group and pair of methods, in the order of :attr:`MixedModel.contrasts`.
    """
    design = read_design(
        table,
        response=response,
        group=group,
        method=method,
        subject=subject,
        groups=groups,
        methods=methods,
    )
    means = _means(design)
    pairs = itertools.combinations(range(len(design.method.names)), 2)
    every = itertools.product(range(len(design.group.names)), list(pairs))
    return tuple(_contrast(design, means, index, *pair) for index, pair in every)


def _means(design: Design) -> FloatArray:
    """Return each network's mean in each cell, NaN without rows, ``(group, method, network)``."""
    labels = (design.group, design.method, design.subject)
    shape = tuple(len(label.names) for label in labels)
    place = tuple(label.codes for label in labels)
    totals, counts = np.zeros(shape), np.zeros(shape)
    np.add.at(totals, place, design.response)
    np.add.at(counts, place, 1.0)
    return np.divide(totals, counts, out=np.full(shape, np.nan), where=counts > 0)


def _contrast(
    design: Design, means: FloatArray, group: int, method: int, reference: int
) -> NetworkContrast:
    pair = means[group, [method, reference]]
    paired = ~np.isnan(pair).any(axis=0)
    differences = pair[0, paired] - pair[1, paired]
    names = np.array(design.subject.names)
    mean = sd = reason = None
    if differences.size:
        mean = float(differences.mean())
    if differences.size > 1:
        alike = np.ptp(differences) <= ROUNDING * np.abs(pair[:, paired]).max()
        sd = 0.0 if alike else float(differences.std(ddof=1))
    else:
        reason = (
            f"In group `{design.group.names[group]}` fewer than two networks have rows of both "
            f"{design.method.names[method]} and {design.method.names[reference]}, so nothing is "
            "known of how their difference varies over networks."
        )
    return NetworkContrast(
        group=design.group.names[group],
        method=design.method.names[method],
        reference=design.method.names[reference],
        networks=tuple(names[paired].tolist()),
        differences=tuple(differences.tolist()),
        left_out=tuple(names[~paired].tolist()),
        mean=mean,
        sd=sd,
        lowest=float(differences.min()) if differences.size else None,
        highest=float(differences.max()) if differences.size else None,
        same_sign=int((differences * mean > 0).sum()) if mean else 0,
        reason=reason,
    )
