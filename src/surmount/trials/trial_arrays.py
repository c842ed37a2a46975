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
        If there are not as many entries as trials, an array holds something else than numbers or
        has not as many columns as there are names, a name is given twice or means something else
        in a table of trials, or the table that they make has problems.
    """
    _check_names(feature_names)
    width = len(feature_names)
    arrays = [_steps(one, place, width) for place, one in enumerate(features)]
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
    lengths = [one.shape[0] for one in arrays]
    table: dict[str, Any] = {
        name: np.repeat(_one_per_trial(name, values, len(arrays)), lengths)
        for name, values in told.items()
    }
    table["trial"] = np.repeat(np.arange(len(arrays)), lengths)
    stacked = np.concatenate(arrays) if arrays else np.empty((0, width))
    table |= {name: stacked[:, place] for place, name in enumerate(feature_names)}
    return trials_from_table(table, source="The arrays of trials")


def _steps(features: Any, place: int, width: int) -> FloatArray:
    """Return the features of one trial as numbers, shape ``(step, feature)``."""
    try:
        steps = np.asarray(features, dtype=np.float64)
    except (ValueError, TypeError) as error:
        raise InputError(
            f"The features of trial {place} are no array of numbers ({error}).",
            remedy="Give each trial one row of numbers per step.",
        ) from error
    if steps.ndim != 2 or steps.shape[1] != width or steps.shape[0] == 0:
        raise InputError(
            f"The features of trial {place} have shape {steps.shape}, expected (steps, {width}).",
            remedy="Give each trial one row per step and one column per feature name.",
        )
    return steps


def _one_per_trial(name: str, values: Any, n_trials: int) -> np.ndarray[Any, Any]:
    """Return what is told of each trial, shape ``(trial,)``."""
    try:
        told = np.asarray(values)
    except ValueError:  # entries of unequal length
        told = np.empty((n_trials, 0))
    if told.ndim != 1:
        several = '{"width_m": [0.6, 0.7], "height_m": [0.1, 0.1]}'
        raise InputError(
            f"`{name}` has not one value per trial.",
            remedy="Give one entry per trial; where there are several task parameters, a "
            f"dictionary with one for each, as {several}."
            if name == "variant"
            else "Give one entry per trial.",
        )
    if told.size != n_trials:
        raise InputError(
            f"`{name}` has {told.size} entries for {n_trials} trials.",
            remedy="Give one entry per trial.",
        )
    return told


def _check_names(names: Sequence[str]) -> None:
    """Refuse names that two features share, or that a table of trials has for something else."""
    for place, name in enumerate(names):
        if name in names[:place] or is_own_column(name):
            why = "of two features" if name in names[:place] else "of no feature in such a table"
            raise InputError(
                f"`{name}` is the name {why}.", remedy="Give each feature a name of its own."
            )
