"""What trials came to, over all networks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray, IntArray
from surmount.trials.table import read_trials
from surmount.trials.trials import Trials, success_rates
from surmount.workflow.run_layout import ARMS, TRIALS_FILE
from surmount.workflow.store import Artefact

PATHS = ("sprawl_deg", "fbem_deg")
"""Features whose path lengths the paper compares (III-D)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Outcomes:
    """What the trials of all networks after one stage of learning came to.

    Attributes
    ----------
    parameters
        Names of the task parameters.
    variant
        Shape ``(trial, parameter)``.
    network, repetition, success
        Shape ``(trial,)`` each.
    end_s
        Time in s at which each trial ended, ``(trial,)``.
    path_lengths
        Σ|Δ| of each feature of :data:`PATHS` that was logged, ``(trial,)``.
    """

    parameters: tuple[str, ...]
    variant: FloatArray
    network: IntArray
    repetition: IntArray
    success: BoolArray
    end_s: FloatArray
    path_lengths: Mapping[str, FloatArray]

    def means(self, values: BoolArray | FloatArray, mask: BoolArray) -> FloatArray:
        """Return each network's mean of values over chosen trials, nan without any: ``(network,)``.

        Parameters
        ----------
        values, mask
            Shape ``(trial,)`` each.
        """
        chosen = (mask & (self.network == network) for network in np.unique(self.network))
        return np.array([values[own].mean() if own.any() else np.nan for own in chosen])

    def scores(self) -> FloatArray:
        """Return each network's success rate on each variant, shape ``(network, variant)``."""
        return success_rates(self.variant, self.network, self.success)


def arm_differences(
    tests: Mapping[str, Outcomes],
    values: Callable[[Outcomes], BoolArray | FloatArray],
    chosen: Callable[[Outcomes], BoolArray],
) -> FloatArray:
    """Return each network's mean with the curriculum minus without, shape ``(network,)``.

    Parameters
    ----------
    tests
        Of both arms, by arm.
    values, chosen
        What is averaged, and which trials count, ``(trial,)`` each.
    """
    first, second = (tests[arm].means(values(tests[arm]), chosen(tests[arm])) for arm in ARMS)
    return first - second


def read_outcomes(artefacts: Iterable[Artefact]) -> Outcomes:
    """Return what the trials of several networks came to, network after network."""
    parts = [_outcomes(read_trials(artefact.path(TRIALS_FILE))) for artefact in artefacts]
    paths = [name for name in PATHS if all(name in part.path_lengths for part in parts)]
    return Outcomes(
        parameters=parts[0].parameters,
        variant=np.concatenate([part.variant for part in parts]),
        network=np.concatenate([part.network for part in parts]),
        repetition=np.concatenate([part.repetition for part in parts]),
        success=np.concatenate([part.success for part in parts]),
        end_s=np.concatenate([part.end_s for part in parts]),
        path_lengths={
            name: np.concatenate([part.path_lengths[name] for part in parts]) for name in paths
        },
    )


def _outcomes(trials: Trials) -> Outcomes:
    return Outcomes(
        parameters=trials.parameters,
        variant=trials.variant,
        network=trials.network,
        repetition=trials.repetition,
        success=trials.success,
        end_s=trials.final("time_s"),
        path_lengths={
            name: trials.path_length(name) for name in PATHS if name in trials.feature_names
        },
    )
