"""Trials from NumPy arrays, one per trial."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.trials.columns import is_own_column
from surmount.trials.table import trials_from_table
from surmount.trials.trials import Trials


def trials_from_arrays(
    features: Sequence[FloatArray],
    *,
    feature_names: Sequence[str],
    variant: Sequence[Any] | Mapping[str, Sequence[Any]],
    success: Sequence[Any],
    network: Sequence[Any] | None = None,
) -> Trials:
    """Build trials from one array per trial.

    Parameters
    ----------
    features
        Of each trial, shape ``(step, feature)``; trials may differ in length.
    feature_names
        Names of the features with their units.
    variant
        Task parameter of each trial, or a sequence for each parameter by its name.
    success
        Outcome of each trial.
    network
        Number or name of the network behind each trial; one for all where absent.

    Raises
    ------
    InputError
        If there are not as many entries as trials, an array has not as many columns as there are
        names, a name is given twice or means something else in a table of trials, or the table
        that they make has problems.
    """
    _check_names(feature_names)
    arrays = [np.asarray(one, dtype=np.float64) for one in features]
    width = len(feature_names)
    for place, one in enumerate(arrays):
        if one.ndim != 2 or one.shape[1] != width or one.shape[0] == 0:
            raise InputError(
                f"The features of trial {place} have shape {one.shape}, expected (steps, {width}).",
                remedy="Give each trial one row per step and one column per feature name.",
            )
    parameters: Mapping[str, Sequence[Any]] = (
        {f"variant.{name}": values for name, values in variant.items()}
        if isinstance(variant, Mapping)
        else {"variant": variant}
    )
    told: dict[str, Sequence[Any]] = {
        **parameters,
        "network": [0] * len(arrays) if network is None else network,
        "success": success,
    }
    for name, values in told.items():
        if len(values) != len(arrays):
            raise InputError(
                f"`{name}` has {len(values)} entries for {len(arrays)} trials.",
                remedy="Give one entry per trial.",
            )
    lengths = [one.shape[0] for one in arrays]
    table: dict[str, Any] = {
        name: np.repeat(np.asarray(values), lengths) for name, values in told.items()
    }
    table["trial"] = np.repeat(np.arange(len(arrays)), lengths)
    stacked = np.concatenate(arrays) if arrays else np.empty((0, width))
    table |= {name: stacked[:, place] for place, name in enumerate(feature_names)}
    return trials_from_table(table, source="The arrays of trials")


def _check_names(names: Sequence[str]) -> None:
    """Refuse names that two features share, or that a table of trials has for something else."""
    for place, name in enumerate(names):
        if name in names[:place] or is_own_column(name):
            why = "of two features" if name in names[:place] else "of no feature in such a table"
            raise InputError(
                f"`{name}` is the name {why}.", remedy="Give each feature a name of its own."
            )
