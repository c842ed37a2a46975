"""Logged trials: the behaviour of one or more policies on the variants of a task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.core.axis import (
    Axes,
    Axis,
    AxisKind,
    common_axes,
    full_axes,
    redeclared,
    stored_values,
)
from surmount.core.errors import InputError


@dataclass(frozen=True, kw_only=True, eq=False)
class Trials:
    """Trials in columns: one row per trial, and one row per control step of all trials together.

    The steps of trial ``i`` are ``features[starts[i]:starts[i + 1]]``.

    Attributes
    ----------
    parameters
        Names of the task parameters, for example ``("height_mm",)``.
    feature_names
        Names of the features with their units, for example ``("time_s", "sprawl_deg")``.
    variant
        Task parameters of each trial, shape ``(trial, parameter)``.
    network
        Index of the network (independent training run) behind each trial, shape ``(trial,)``.
    repetition
        Index of the trial among those of its variant and network, shape ``(trial,)``.
    success
        Whether the trial reached its goal, shape ``(trial,)``.
    starts
        First step of each trial and, last, the number of steps; shape ``(trial + 1,)``.
    features
        One row per control step, shape ``(sample, feature)``.
    network_names
        Name of each network by its index; empty where networks have numbers only.
    notes
        What a reader must know of how these trials were read, in sentences.
    axes
        One for each task parameter, see :mod:`surmount.core.axis`; all are continuous where none
        are given.
    """

    parameters: tuple[str, ...]
    feature_names: tuple[str, ...]
    variant: FloatArray
    network: IntArray
    repetition: IntArray
    success: BoolArray
    starts: IntArray
    features: FloatArray
    network_names: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    axes: Axes = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "axes", full_axes(self.axes, self.parameters))
        trials = self.n_trials
        expected = {
            "variant": (self.variant.shape, (trials, len(self.parameters))),
            "network": (self.network.shape, (trials,)),
            "repetition": (self.repetition.shape, (trials,)),
            "starts": (self.starts.shape, (trials + 1,)),
            "features": (self.features.shape, (self.features.shape[0], len(self.feature_names))),
        }
        for name, (found, wanted) in expected.items():
            if found != wanted:
                raise InputError(
                    f"Trials: `{name}` has shape {found}, expected {wanted}.",
                    remedy="Give one row per trial, and one feature row per control step.",
                )
        steps = np.diff(self.starts)
        if trials == 0 or (steps < 1).any() or self.starts[0] != 0:
            raise InputError(
                "Trials: every trial needs at least one step, and there must be a trial.",
                remedy="Drop empty trials; `starts` begins at 0 and increases.",
            )
        if self.starts[-1] != self.features.shape[0]:
            raise InputError(
                f"Trials: `starts` ends at {self.starts[-1]} but there are "
                f"{self.features.shape[0]} feature rows.",
                remedy="Let `starts` end at the number of feature rows.",
            )

    @property
    def n_trials(self) -> int:
        """Number of trials."""
        return int(self.success.shape[0])

    @property
    def n_samples(self) -> int:
        """Number of control steps over all trials."""
        return int(self.features.shape[0])

    @property
    def lengths(self) -> IntArray:
        """Number of control steps of each trial, shape ``(trial,)``."""
        return np.diff(self.starts)

    def network_name(self, network: int) -> str:
        """Return what a network is called: its name, or its number."""
        return self.network_names[network] if self.network_names else str(network)

    def variants(self) -> tuple[FloatArray, IntArray]:
        """Return the distinct variants in ascending order, and each trial's index into them.

        Returns
        -------
        tuple
            Variants of shape ``(variant, parameter)``, indices of shape ``(trial,)``.
        """
        distinct, index = np.unique(self.variant, axis=0, return_inverse=True)
        return distinct, index.reshape(-1).astype(np.int64)

    def sample_variant(self) -> IntArray:
        """Return each sample's index into :meth:`variants`, shape ``(sample,)``."""
        return np.repeat(self.variants()[1], self.lengths)

    def final(self, feature: str) -> FloatArray:
        """Return a feature's value at the last step of each trial, shape ``(trial,)``."""
        return self.column(feature)[self.starts[1:] - 1]

    def path_length(self, feature: str) -> FloatArray:
        """Return Σ|Δ| of a feature over each trial, shape ``(trial,)`` (paper III-D)."""
        column = self.column(feature)
        change = np.abs(np.diff(column, prepend=column[:1]))
        change[self.starts[:-1]] = 0.0
        return np.add.reduceat(change, self.starts[:-1])

    def column(self, feature: str) -> FloatArray:
        """Return one feature at every step, shape ``(sample,)``."""
        try:
            index = self.feature_names.index(feature)
        except ValueError:
            raise InputError(
                f"Trials have no feature `{feature}`.",
                remedy=f"Choose among {', '.join(self.feature_names)}.",
            ) from None
        return self.features[:, index]

    def select(self, mask: BoolArray) -> Trials:
        """Return the trials where ``mask``, of shape ``(trial,)``, is true."""
        rows = np.repeat(mask, self.lengths)
        return Trials(
            parameters=self.parameters,
            feature_names=self.feature_names,
            variant=self.variant[mask],
            network=self.network[mask],
            repetition=self.repetition[mask],
            success=self.success[mask],
            starts=np.concatenate([[0], np.cumsum(self.lengths[mask])]).astype(np.int64),
            features=self.features[rows],
            network_names=self.network_names,
            notes=self.notes,
            axes=self.axes,
        )

    def on(self, axes: Axes) -> Trials:
        """Return the trials on other axes; categories keep their names.

        Raises
        ------
        InputError
            If a variant cannot lie on its new axis.
        """
        if axes == self.axes:
            return self
        columns = zip(self.axes, axes, self.parameters, self.variant.T, strict=True)
        variant = np.stack([_moved(old, new, name, one) for old, new, name, one in columns], 1)
        return replace(self, variant=variant, axes=axes)

    def declared(self, kinds: Mapping[str, AxisKind]) -> Trials:
        """Return the trials with task parameters of other kinds than their table told.

        Parameters
        ----------
        kinds
            By parameter; numbers that are said to be categories are named as they are written.

        Raises
        ------
        InputError
            If there is no such parameter, or its values cannot lie on such an axis.
        """
        axes, variant = redeclared(
            self.axes, self.variant, self.parameters, kinds, called="task parameter"
        )
        return replace(self, variant=variant, axes=axes)

    @classmethod
    def concatenate(cls, parts: Sequence[Trials]) -> Trials:
        """Join trials of the same task family and features, in the order given.

        Categories are those of all parts.
        """
        first = parts[0]
        for part in parts[1:]:
            if _made_of(part) != _made_of(first):
                raise InputError(
                    f"Trials to join differ in parameters or features: {_made_of(first)} "
                    f"and {_made_of(part)}.",
                    remedy="Join only trials of one task family, logged alike.",
                )
        axes = common_axes([part.axes for part in parts], first.parameters)
        parts = [part.on(axes) for part in parts]
        lengths = np.concatenate([part.lengths for part in parts])
        network, names = _pooled_networks(parts)
        return cls(
            parameters=first.parameters,
            feature_names=first.feature_names,
            variant=np.concatenate([part.variant for part in parts]),
            network=network,
            repetition=np.concatenate([part.repetition for part in parts]),
            success=np.concatenate([part.success for part in parts]),
            starts=np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64),
            features=np.concatenate([part.features for part in parts]),
            axes=axes,
            network_names=names,
            notes=tuple(dict.fromkeys(note for part in parts for note in part.notes)),
        )


def _made_of(trials: Trials) -> tuple[object, ...]:
    return trials.parameters, trials.feature_names


def _pooled_networks(parts: Sequence[Trials]) -> tuple[IntArray, tuple[str, ...]]:
    """Return the networks of several parts: one numbering where any of them has names."""
    if not any(part.network_names for part in parts):
        return np.concatenate([part.network for part in parts]), ()
    called = [[part.network_name(one) for one in part.network.tolist()] for part in parts]
    names, number = np.unique(np.concatenate(called), return_inverse=True)
    return number.reshape(-1).astype(np.int64), tuple(names.tolist())


def _moved(old: Axis, new: Axis, name: str, column: FloatArray) -> FloatArray:
    distinct, which = np.unique(column, return_inverse=True)
    values = [old.value(float(one)) for one in distinct]
    return stored_values(name, values, new)[which.reshape(-1)]


def success_rates(variant: FloatArray, network: IntArray, success: BoolArray) -> FloatArray:
    """Return the success rate of each network on each variant, shape ``(network, variant)``.

    Parameters
    ----------
    variant
        Of every trial, shape ``(trial, parameter)``.
    network, success
        Of every trial, shape ``(trial,)``.
    """
    variants, which = np.unique(variant, axis=0, return_inverse=True)
    networks, whose = np.unique(network, return_inverse=True)
    cell = whose * len(variants) + which.reshape(-1)
    cells = len(networks) * len(variants)
    total = np.bincount(cell, minlength=cells)
    won = np.bincount(cell[success], minlength=cells)
    return (won / total).reshape(len(networks), len(variants))
