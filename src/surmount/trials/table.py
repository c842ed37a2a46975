"""Trials as a long table: one row per control step, from any robot (Parquet, CSV, or arrays).

Columns (version 1 of the contract, ``docs/trial-table.md``): ``variant`` with a number, or
``variant.<name>`` for each parameter of the task; ``network``, ``trial`` and ``success``; every
other column is a feature, ``time_s`` included. Rows of one trial stand in the order of time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.arrays import IntArray
from surmount.core.axis import axes_to_record, variant_text
from surmount.trials.coded_column import CodeArray, row_pieces
from surmount.trials.table_check import Table, checked_columns
from surmount.trials.table_file import read_columns, write_columns
from surmount.trials.table_problems import Problems
from surmount.trials.trials import Trials

_SAME = 1e-9
"""Relative difference below which two values of a task parameter are taken for one."""


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
    axes = axes_to_record(trials.axes, trials.parameters)
    write_columns(Path(path), trials_to_table(trials), axes)


def trials_to_table(trials: Trials) -> dict[str, np.ndarray[Any, Any]]:
    """Return trials as columns of equal length, one row per control step.

    Categories are written by their names, whole numbers as such.
    """
    lengths = trials.lengths
    table: dict[str, np.ndarray[Any, Any]] = {}
    for index, (name, axis) in enumerate(zip(trials.parameters, trials.axes, strict=True)):
        column = "variant" if trials.parameters == ("variant",) else f"variant.{name}"
        values = np.array([axis.value(float(one)) for one in trials.variant[:, index]])
        table[column] = np.repeat(values, lengths)
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
    if columns.varied:
        _check_variants(columns, minimum_variants, minimum_samples, problems)
    if not columns.identified:
        problems.raise_if_any(source)
    first, trial = _trial_rows(columns)
    in_order = bool((trial[1:] >= trial[:-1]).all())
    order = None if in_order else np.argsort(trial, kind="stable")
    starts = np.concatenate([[0], np.cumsum(np.bincount(trial))]).astype(np.int64)
    _check_trials(columns, trial, first, starts, order, problems)
    problems.raise_if_any(source)
    if order is not None:
        for feature in columns.features.T:  # one by one: each makes a copy
            feature[:] = feature[order]
    return Trials(
        parameters=columns.parameters,
        feature_names=columns.feature_names,
        variant=columns.variant.distinct[columns.variant.code[first]],
        network=columns.network.distinct[columns.network.code[first]],
        repetition=columns.trial.distinct[columns.trial.code[first]],
        success=columns.success[first],
        starts=starts,
        features=columns.features,
        axes=columns.axes,
    )


def _trial_rows(columns: Table) -> tuple[IntArray, CodeArray]:
    """Group rows by trial.

    Returns
    -------
    tuple
        The first row of each trial, and the trial of each row; trials are numbered in the order
        of their first rows.
    """
    found = columns.variant.paired(columns.network).paired(columns.trial)
    n_rows, n_trials = found.code.size, found.distinct.shape[0]
    first = np.full(n_trials, n_rows, dtype=np.int64)
    for rows in row_pieces(n_rows):
        present, place = np.unique(found.code[rows], return_index=True)
        first[present] = np.minimum(first[present], place + rows.start)
    rank = np.empty(n_trials, dtype=np.int32)
    rank[np.argsort(first)] = np.arange(n_trials, dtype=np.int32)
    return np.sort(first), rank[found.code]


def _check_trials(
    columns: Table,
    trial: CodeArray,
    first: IntArray,
    starts: IntArray,
    order: IntArray | None,
    problems: Problems,
) -> None:
    changed = np.flatnonzero(columns.success != columns.success[first][trial])
    problems.rows(
        changed.astype(np.int64),
        "`success` differs from the first row of the same trial",
        "`success` is the outcome of the whole trial: repeat it on each of its rows.",
    )
    if "time_s" not in columns.feature_names:
        return  # a robot at rest logs equal rows: without a time they are not duplicates
    time = columns.features[:, columns.feature_names.index("time_s")]
    again: list[IntArray] = []
    for begin, end in _whole_trials(starts):
        rows = np.arange(begin, end) if order is None else order[begin:end]
        by_time = rows[np.lexsort((time[rows], trial[rows]))]
        equal = (np.diff(trial[by_time]) == 0) & (np.diff(time[by_time]) == 0.0)
        again.append(by_time[1:][equal])
    problems.rows(
        np.sort(np.concatenate(again)),
        "the same `time_s` as in another row of the same trial",
        "Remove duplicate rows, or give each repetition its own number in `trial`.",
    )


def _whole_trials(starts: IntArray) -> Iterator[tuple[int, int]]:
    """Divide ordered rows where trials end, into as many pieces as memory asks for."""
    for piece in row_pieces(int(starts[-1])):
        inside = starts[(starts >= piece.start) & (starts < piece.stop)]
        if inside.size:
            following = starts[np.searchsorted(starts, piece.stop)]
            yield int(inside[0]), int(following)


def _check_variants(
    columns: Table, minimum_variants: int, minimum_samples: int, problems: Problems
) -> None:
    axes, variant = columns.axes, columns.variant
    variants, counts = variant.distinct, np.bincount(variant.code)
    if variants.shape[0] < minimum_variants:
        problems.add(
            f"there is only one variant ({variant_text(axes, variants[0])})"
            if variants.shape[0] == 1
            else f"there are only {variants.shape[0]} variants",
            f"Record trials on at least {minimum_variants} variants of the task.",
        )
    for axis, column in zip(axes, variants.T, strict=True):
        if axis.discrete:
            continue
        values = np.unique(column)
        close = np.flatnonzero(np.diff(values) <= _SAME * np.abs(values[1:]))
        for left, right in zip(values[close], values[close + 1], strict=True):
            problems.add(
                f"variants {float(left)!r} and {float(right)!r} differ by rounding only",
                "Write the same number on all rows of a variant.",
            )
    for value, count in zip(variants, counts, strict=True):
        if count < minimum_samples:
            problems.add(
                f"variant {variant_text(axes, value)} has {count} rows, fewer than "
                f"{minimum_samples}",
                "Record more trials on it, or leave the variant out.",
            )
