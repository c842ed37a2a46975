"""Trials as a long table: one row per control step, from any robot, whatever wrote it.

Columns (version 1 of the contract, ``docs/trial-table.md``): ``variant`` with a number or a name,
or ``variant.<name>`` for each parameter of the task; ``network``, ``trial`` and ``success``; every
other column is a feature, ``time_s`` included. Rows of one trial stand in the order of time. Tables
with columns of other names are read by saying which column holds what
(:class:`surmount.trials.columns.Columns`).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.axis import axes_to_record
from surmount.core.errors import InputError
from surmount.trials.checksum import without_panics
from surmount.trials.columns import Columns
from surmount.trials.frame_columns import open_frame
from surmount.trials.log_folder import open_path
from surmount.trials.roles import find_roles
from surmount.trials.row_numbers import without_row_numbers
from surmount.trials.source import Source
from surmount.trials.table_file import write_columns
from surmount.trials.table_problems import Problems
from surmount.trials.table_reading import read_source
from surmount.trials.trials import Trials


def read_trials(
    path: Path | str,
    *,
    columns: Columns | None = None,
    minimum_variants: int = 1,
    minimum_samples: int = 1,
) -> Trials:
    """Read trials from a file, or from a folder of files.

    Parameters
    ----------
    path
        CSV, Parquet or Arrow file, a folder of them, or a Minari data set; ``docs/formats.md`` has
        the list.
    columns
        Which columns hold what; found by their names where absent.
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
        If a Minari data set is to be read and the extra ``minari`` is not installed.
    """
    wanted = columns or Columns()
    with without_panics():
        source = open_path(Path(path), wanted)
        return _read(source, wanted, minimum_variants, minimum_samples)


def trials_from_table(
    table: Any,
    *,
    columns: Columns | None = None,
    minimum_variants: int = 1,
    minimum_samples: int = 1,
    source: str = "The table of trials",
) -> Trials:
    """Build trials from columns: a dictionary of arrays, or a data frame of any library.

    Parameters
    ----------
    table
        Columns of equal length by name: a dictionary of arrays, or a data frame of pandas, Polars
        (lazy ones too) or Arrow.
    columns, minimum_variants, minimum_samples
        As in :func:`read_trials`.
    source
        How errors name the table.

    Raises
    ------
    InputError
        Naming every problem of the table at once.
    """
    opened = open_frame(table, source)
    return _read(opened, columns or Columns(), minimum_variants, minimum_samples)


def write_trials(path: Path | str, trials: Trials) -> None:
    """Write trials as a long table, whole or not at all.

    Raises
    ------
    InputError
        If the path ends neither in ``.parquet`` nor in ``.csv``, or a feature has the name of
        another column.
    """
    axes = axes_to_record(trials.axes, trials.parameters)
    write_columns(Path(path), trials_to_table(trials), axes)


def trials_to_table(trials: Trials) -> dict[str, np.ndarray[Any, Any]]:
    """Return trials as columns of equal length, one row per control step; names stay names.

    Raises
    ------
    InputError
        If a feature has the name of another column.
    """
    lengths = trials.lengths
    table: dict[str, np.ndarray[Any, Any]] = {}
    for index, (name, axis) in enumerate(zip(trials.parameters, trials.axes, strict=True)):
        column = "variant" if trials.parameters == ("variant",) else f"variant.{name}"
        values = np.array([axis.value(float(one)) for one in trials.variant[:, index]])
        table[column] = np.repeat(values, lengths)
    network = trials.network
    if trials.network_names:
        network = np.asarray(trials.network_names)[network]
    table["network"] = np.repeat(network, lengths)
    table["trial"] = np.repeat(trials.repetition, lengths)
    table["success"] = np.repeat(trials.success, lengths)
    for index, name in enumerate(trials.feature_names):
        if name in table:
            raise InputError(
                f"The feature `{name}` has the name of another column of a table of trials.",
                remedy="Give the feature another name.",
            )
        table[name] = trials.features[:, index]
    return table


def _read(source: Source, columns: Columns, minimum_variants: int, minimum_samples: int) -> Trials:
    problems = Problems(place=source.place)
    source = without_row_numbers(source, columns, problems)
    roles = find_roles(tuple(source.schema()), columns, problems)
    return read_source(
        source,
        roles,
        columns,
        problems,
        minimum_variants=minimum_variants,
        minimum_samples=minimum_samples,
    )
