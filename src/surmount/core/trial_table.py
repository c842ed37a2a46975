"""Trials as a long table: one row per control step, from any robot (Parquet, CSV, or arrays).

Columns (version 1 of the contract, ``docs/trial-table.md``): ``variant`` with a number, or
``variant.<name>`` for each parameter of the task; ``network``, ``trial`` and ``success``; every
other column is a feature, ``time_s`` included. Rows of one trial stand in the order of time.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.table_check import Problems, Table, checked_columns
from surmount.core.table_file import read_columns, write_columns
from surmount.core.trials import Trials


def read_trials(path: Path | str, *, minimum_variants: int = 1, minimum_samples: int = 1) -> Trials:
    """Read trials from a Parquet or CSV file.

    Parameters
    ----------
    path
        File ending in ``.parquet`` or ``.csv``.
    minimum_variants, minimum_samples
        Variants, and rows per variant, below which the table is refused; an analysis needs 2
        variants and ``min_samples_per_component`` rows.

    Returns
    -------
    Trials
        One entry per combination of variant, network and trial, in the order of their first rows.

    Raises
    ------
    InputError
        Naming every problem of the table at once, with row numbers (the first row below the
        header is row 1) and what to do.
    MissingExtraError
        If Parquet is to be read and the extra ``tables`` is not installed.
    """
    table = read_columns(Path(path))
    return trials_from_table(
        table,
        minimum_variants=minimum_variants,
        minimum_samples=minimum_samples,
        source=str(path),
    )


def write_trials(path: Path | str, trials: Trials) -> None:
    """Write trials as a long table, whole or not at all.

    Raises
    ------
    InputError
        If the path ends neither in ``.parquet`` nor in ``.csv``.
    MissingExtraError
        If Parquet is to be written and the extra ``tables`` is not installed.
    """
    write_columns(Path(path), trials_to_table(trials))


def trials_to_table(trials: Trials) -> dict[str, np.ndarray[Any, Any]]:
    """Return trials as columns of equal length, one row per control step."""
    lengths = trials.lengths
    table: dict[str, np.ndarray[Any, Any]] = {}
    for index, name in enumerate(trials.parameters):
        column = "variant" if trials.parameters == ("variant",) else f"variant.{name}"
        table[column] = np.repeat(trials.variant[:, index], lengths)
    table["network"] = np.repeat(trials.network, lengths)
    table["trial"] = np.repeat(trials.repetition, lengths)
    table["success"] = np.repeat(trials.success, lengths)
    for index, name in enumerate(trials.feature_names):
        table[name] = trials.features[:, index]
    return table


def trials_from_table(
    table: Mapping[str, Any],
    *,
    minimum_variants: int = 1,
    minimum_samples: int = 1,
    source: str = "The table of trials",
) -> Trials:
    """Build trials from columns: a dictionary of arrays, or a pandas or polars data frame.

    Parameters
    ----------
    table
        Columns of equal length by name.
    minimum_variants, minimum_samples
        As in :func:`read_trials`.
    source
        How errors name the table.

    Raises
    ------
    InputError
        Naming every problem of the table at once.
    """
    problems = Problems()
    columns = checked_columns(table, problems)
    problems.raise_if_any(source)
    order, first, trial = _trial_rows(columns)
    _check_trials(columns, trial, first, problems)
    _check_variants(columns, minimum_variants, minimum_samples, problems)
    problems.raise_if_any(source)
    starts = np.append(np.flatnonzero(np.diff(trial[order], prepend=-1)), order.size)
    in_order = bool((order == np.arange(order.size)).all())
    features = columns.features if in_order else columns.features[order]
    return Trials(
        parameters=columns.parameters,
        feature_names=columns.feature_names,
        variant=columns.variant[first],
        network=columns.network[first],
        repetition=columns.trial[first],
        success=columns.success[first] > 0.5,
        starts=starts.astype(np.int64),
        features=features,
    )


def _trial_rows(columns: Table) -> tuple[IntArray, IntArray, IntArray]:
    """Group rows by trial.

    Returns
    -------
    tuple
        Rows in the order of trials, the first row of each trial, and the trial of each row;
        trials are numbered in the order of their first rows.
    """
    _, variant = np.unique(columns.variant, axis=0, return_inverse=True)
    _, network = np.unique(columns.network, return_inverse=True)
    _, repetition = np.unique(columns.trial, return_inverse=True)
    variant = variant.reshape(-1)
    key = (variant * (network.max() + 1) + network) * (repetition.max() + 1) + repetition
    _, first, trial = np.unique(key, return_index=True, return_inverse=True)
    rank = np.empty(first.size, dtype=np.int64)
    rank[np.argsort(first)] = np.arange(first.size)
    trial = rank[trial]
    return np.argsort(trial, kind="stable").astype(np.int64), np.sort(first), trial


def _check_trials(columns: Table, trial: IntArray, first: IntArray, problems: Problems) -> None:
    changed = np.flatnonzero(columns.success != columns.success[first][trial])
    problems.rows(
        changed,
        "`success` differs from the first row of the same trial",
        "`success` is the outcome of the whole trial: repeat it on each of its rows.",
    )
    if "time_s" not in columns.feature_names:
        return  # a robot at rest logs equal rows: without a time they are not duplicates
    time = columns.features[:, columns.feature_names.index("time_s")]
    order = np.lexsort((np.arange(time.size), time, trial))
    again = (np.diff(trial[order]) == 0) & (np.diff(time[order]) == 0.0)
    problems.rows(
        np.sort(order[1:][again]),
        "has the same `time_s` as another row of the same trial",
        "Remove duplicate rows, or give each repetition its own number in `trial`.",
    )


def _check_variants(
    columns: Table, minimum_variants: int, minimum_samples: int, problems: Problems
) -> None:
    variants, counts = np.unique(columns.variant, axis=0, return_counts=True)
    if variants.shape[0] < minimum_variants:
        problems.add(
            f"there is only one variant ({_text(variants[0])})"
            if variants.shape[0] == 1
            else f"there are only {variants.shape[0]} variants",
            f"Record trials on at least {minimum_variants} variants of the task.",
        )
    for variant, count in zip(variants, counts, strict=True):
        if count < minimum_samples:
            problems.add(
                f"variant {_text(variant)} has {count} rows, fewer than {minimum_samples}",
                "Record more trials on it, or leave the variant out.",
            )


def _text(variant: FloatArray) -> str:
    return ", ".join(f"{value:g}" for value in variant)
