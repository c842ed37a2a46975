"""What is asked of a group × method table of means, some of whose cells may be empty."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space

from surmount.core.arrays import FloatArray, IntArray
from surmount.stats.mixed.inference import Estimate, MeansLaw, estimate, joint_test
from surmount.stats.result import Result


@dataclass(frozen=True, kw_only=True)
class CellMean(Result):
    """Estimated mean of the response for one method in one group, in units of the response.

    Numbers are ``None`` where undefined: all of them in an empty cell, all but the estimate where
    the variances cannot be estimated.
    """

    group: str
    method: str
    n_rows: int
    estimate: float | None
    std_error: float | None
    degrees_of_freedom: float | None
    lower: float | None
    upper: float | None


@dataclass(frozen=True, kw_only=True)
class MethodContrast(Result):
    """Estimated difference between two methods within one group.

    Attributes
    ----------
    group
        The group.
    method, reference
        The estimate is the mean of ``method`` minus that of ``reference``.
    estimate, std_error, lower, upper
        Difference, its standard error and interval, in units of the response.
    degrees_of_freedom, t, p_value
        Two-sided t-test that the difference is zero, not adjusted for the number of contrasts.
    reason
        Why numbers are ``None``, if any is.
    """

    group: str
    method: str
    reference: str
    estimate: float | None
    std_error: float | None
    degrees_of_freedom: float | None
    t: float | None
    p_value: float | None
    lower: float | None
    upper: float | None
    reason: str | None


@dataclass(frozen=True, kw_only=True)
class Interaction(Result):
    """F-test that the difference between methods is the same in all groups."""

    statistic: float | None
    numerator_df: int | None
    denominator_df: float | None
    p_value: float | None
    reason: str | None


@dataclass(frozen=True, kw_only=True, eq=False)
class Cells:
    """The crossed cells of a fit, some of them empty, and what is asked of them.

    ``present`` holds the index ``group · n_methods + method`` of each cell that has rows, in the
    order of the law's cells; ``law`` is ``None`` where ``reason`` says why.
    """

    groups: tuple[str, ...]
    methods: tuple[str, ...]
    present: IntArray
    counts: IntArray
    arithmetic_means: FloatArray
    law: MeansLaw | None
    confidence: float
    reason: str | None

    def _position(self, group: int, method: int) -> int | None:
        """Return where a cell stands among those that have rows."""
        found = np.flatnonzero(self.present == group * len(self.methods) + method)
        return int(found[0]) if found.size else None

    def means(self) -> tuple[CellMean, ...]:
        """Return the mean of every cell, groups outermost."""
        every = itertools.product(range(len(self.groups)), range(len(self.methods)))
        return tuple(self._mean(group, method) for group, method in every)

    def _mean(self, group: int, method: int) -> CellMean:
        position = self._position(group, method)
        weights = None if position is None else np.eye(self.present.size)[position]
        value, found = self._estimate(weights)
        return CellMean(
            group=self.groups[group],
            method=self.methods[method],
            n_rows=0 if position is None else int(self.counts[position]),
            estimate=value,
            std_error=found and found.std_error,
            degrees_of_freedom=found and found.degrees_of_freedom,
            lower=found and found.lower,
            upper=found and found.upper,
        )

    def _estimate(self, weights: FloatArray | None) -> tuple[float | None, Estimate | None]:
        """Return a contrast's value, if its cells have rows, and what the law says of it."""
        if weights is None:
            return None, None
        if self.law is None:
            return float(weights @ self.arithmetic_means), None
        found = estimate(self.law, weights, self.confidence)
        return found.value, found

    def contrasts(self) -> tuple[MethodContrast, ...]:
        """Return the difference of every pair of methods within every group."""
        pairs = list(itertools.combinations(range(len(self.methods)), 2))
        every = itertools.product(range(len(self.groups)), pairs)
        return tuple(self._contrast(group, *pair) for group, pair in every)

    def _contrast(self, group: int, method: int, reference: int) -> MethodContrast:
        first, second = self._position(group, method), self._position(group, reference)
        reason, weights = self.reason, None
        if first is None or second is None:
            empty = [
                self.methods[index]
                for index, position in ((method, first), (reference, second))
                if position is None
            ]
            reason = f"Group `{self.groups[group]}` has no row of {' nor of '.join(empty)}."
        else:
            weights = np.eye(self.present.size)[first] - np.eye(self.present.size)[second]
        value, found = self._estimate(weights)
        return MethodContrast(
            group=self.groups[group],
            method=self.methods[method],
            reference=self.methods[reference],
            estimate=value,
            std_error=found and found.std_error,
            degrees_of_freedom=found and found.degrees_of_freedom,
            t=found and found.t,
            p_value=found and found.p_value,
            lower=found and found.lower,
            upper=found and found.upper,
            reason=reason,
        )

    def interaction(self) -> Interaction:
        """Test whether the differences between methods are the same in all groups."""
        weights = self._interaction_contrasts()
        found = None
        reason = self.reason
        if weights.shape[0] == 0:
            reason = (
                "An interaction needs at least two methods that meet in at least two groups, which "
                "these rows do not have."
            )
        elif self.law is not None:
            found = joint_test(self.law, weights)
            if found is None:
                reason = (
                    "With so few rows the correction yields no positive degrees of freedom for "
                    "the joint test."
                )
        return Interaction(
            statistic=found and found.statistic,
            numerator_df=found and found.numerator_df,
            denominator_df=found and found.denominator_df,
            p_value=found and found.p_value,
            reason=reason,
        )

    def _interaction_contrasts(self) -> FloatArray:
        """Return independent contrasts that vanish without interaction, ``(contrast, cell)``."""
        n_groups, n_methods = len(self.groups), len(self.methods)
        identity = np.eye(self.present.size)
        if self.present.size == n_groups * n_methods:
            # How far each method's distance to the first differs from that in the first group.
            grid = identity.reshape(n_groups, n_methods, -1)
            against_first = grid[:, 1:] - grid[:, :1]
            return (against_first[1:] - against_first[:1]).reshape(-1, self.present.size)
        # With empty cells: whatever group effects plus method effects cannot produce.
        rows, columns = np.divmod(self.present, n_methods)
        additive = np.hstack([np.eye(n_groups)[rows], np.eye(n_methods)[columns]])
        return null_space(additive.T).T
