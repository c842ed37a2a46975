"""Checks on the columns of a table of trials, all problems gathered before anything is refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.axis import Axes, Axis, stored_values
from surmount.core.errors import InputError
from surmount.core.names import LONGEST_NAME, is_printable
from surmount.trials import column_values
from surmount.trials.coded_column import Coded, coded_combinations
from surmount.trials.table_file import Column, FileColumns
from surmount.trials.table_problems import Problems

_KEYS = ("network", "trial", "success")
_COLUMN_REMEDIES = {
    "variant": "Add the task parameter of each row as `variant`, or as `variant.<name>` for each "
    "of several parameters.",
    "network": "Add the number of the policy that acted; 0 throughout if there is one.",
    "trial": "Add the number of the repetition among those of its variant and network.",
    "success": "Add the outcome of the trial, 1 or 0, on each of its rows.",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """Columns of a table of trials, one entry per row.

    Attributes
    ----------
    parameters, feature_names
        Names of the task parameters and of the features.
    variant
        Distinct variants, shape ``(variant, parameter)``.
    network, trial
        Distinct integers; names are numbered in alphabetical order.
    success
        Shape ``(row,)``.
    features
        Shape ``(row, feature)``, each feature contiguous.
    axes
        One per task parameter, as the file says, or as the values tell.
    varied
        Whether the columns of the task parameters are there and sound.
    identified
        Whether the columns that say which trial a row belongs to are sound.
    """

    parameters: tuple[str, ...]
    feature_names: tuple[str, ...]
    variant: Coded
    network: Coded
    trial: Coded
    success: BoolArray
    features: FloatArray
    axes: Axes
    varied: bool
    identified: bool


def checked_columns(table: Mapping[str, Any], problems: Problems) -> Table:
    """Return a table's columns as numbers, noting every problem of their names and values.

    Parameters
    ----------
    table
        Columns by name.
    problems
        Where problems are noted; the result is only to be used if there is none.

    Raises
    ------
    InputError
        If this is no table of columns at all.
    """
    columns = table if isinstance(table, FileColumns) else _arrays(table, problems)
    names = list(columns)
    _check_names(names, problems)
    n_rows = columns.n_rows if isinstance(columns, FileColumns) else _row_count(columns, problems)
    if n_rows == 0:
        problems.add("the table has no rows", "Log at least one trial.")
    if not n_rows:
        return _empty()

    def numbers(name: str) -> FloatArray:
        if name not in names:
            return np.zeros(n_rows)
        return column_values.numbers(name, columns[name], problems)

    def labels(name: str, found: Problems) -> Coded:
        if name not in names:
            return Coded(distinct=np.zeros(1, np.int64), code=np.zeros(n_rows, np.int32))
        return column_values.labels(name, columns[name], found)

    success = numbers("success")
    problems.rows(
        column_values.rows_where(lambda x: np.isfinite(x) & (x != 0.0) & (x != 1.0), success),
        "`success` is neither 0 nor 1",
        "Write 1 (true) for a trial that reached its goal and 0 (false) for one that did not.",
    )
    reached = success > 0.5
    del success
    parameters = [name for name in names if _is_parameter(name)]
    before = len(problems.found)
    told = columns.axes if isinstance(columns, FileColumns) else {}
    found = [_parameter(name, columns[name], told, problems) for name in parameters]
    variant = coded_combinations([values for values, _ in found] or [np.zeros(n_rows)])
    axes = tuple(axis for _, axis in found)
    del found
    varied = bool(parameters) and len(problems.found) == before
    # Identities before features, so that the space they need while being coded is free again.
    about_labels = Problems()
    network, trial = labels("network", about_labels), labels("trial", about_labels)
    features = [name for name in names if not _is_parameter(name) and name not in _KEYS]
    identified = not problems.found and not about_labels.found
    values = np.empty((len(features), n_rows)).T
    for index, name in enumerate(features):
        values[:, index] = numbers(name)
    problems.found.extend(about_labels.found)
    return Table(
        parameters=tuple(name.removeprefix("variant.") for name in parameters),
        feature_names=tuple(features),
        variant=variant,
        network=network,
        trial=trial,
        success=reached,
        features=values,
        axes=axes,
        varied=varied,
        identified=identified,
    )


def _parameter(
    column: str, array: Column, told: Mapping[str, Any], problems: Problems
) -> tuple[FloatArray, Axis]:
    """Return a column of a task parameter on the axis that the file says it has."""
    values, axis = column_values.parameter(column, array, problems)
    name = column.removeprefix("variant.")
    if name not in told or not np.isfinite(values).all():
        return values, axis
    try:
        said = Axis.from_record(told[name])
        distinct, which = np.unique(values, return_inverse=True)
        given = [axis.value(float(one)) for one in distinct]
        return stored_values(name, given, said)[which.reshape(-1)], said
    except (InputError, KeyError, TypeError, AttributeError):
        problems.add(
            f"`{column}` does not lie on the axis that the file says it has",
            "Write the table again with `surmount.write_trials`.",
        )
        return values, axis


def _is_parameter(name: str) -> bool:
    return name == "variant" or name.startswith("variant.")


def _arrays(table: Any, problems: Problems) -> dict[str, Column]:
    """Return the columns of a dictionary or data frame whose names are not ambiguous."""
    kind = type(table).__name__
    if hasattr(type(table), "collect"):
        raise InputError(
            f"The table of trials is a {kind}, which has not been computed yet.",
            remedy="Give the data frame that its `collect()` returns.",
        )
    if not isinstance(table, Mapping) and not hasattr(table, "columns"):
        raise InputError(
            f"The table of trials is a {kind}, not a table of columns.",
            remedy="Give a dictionary of arrays, or a pandas or polars data frame.",
        )
    keys: list[Any] = list(getattr(table, "columns", table))
    names = [str(key) for key in keys]
    again = {name for name in names if names.count(name) > 1}
    for name in sorted(again):
        problems.add(f"several columns have the name `{name}`", "Name each column once.")
    return {
        name: column_values.column_array(table[key])
        for name, key in zip(names, keys, strict=True)
        if name not in again
    }


def _row_count(columns: Mapping[str, Column], problems: Problems) -> int | None:
    """Return the number of rows; ``None``, with a note, where columns do not have as many."""
    odd = [name for name, column in columns.items() if column.ndim != 1]
    for name in odd:
        problems.add(f"`{name}` has not one value per row", "Give one number per row.")
    sizes = {name: column.size for name, column in columns.items() if column.ndim == 1}
    if len(set(sizes.values())) > 1:
        listed = ", ".join(f"{name} {size}" for name, size in sizes.items())
        problems.add(f"columns differ in length ({listed})", "Give each column one entry per row.")
        return None
    return None if odd else next(iter(sizes.values()), 0)


def _check_names(names: Sequence[str], problems: Problems) -> None:
    several = [name for name in names if name.startswith("variant.")]
    missing = [name for name in _KEYS if name not in names]
    if "variant" not in names and not several:
        missing.insert(0, "variant")
    for name in missing:
        problems.add(f"column `{name}` is missing", _COLUMN_REMEDIES[name])
    if "variant" in names and several:
        problems.add(
            f"there is both `variant` and `{several[0]}`",
            "Keep `variant` for one task parameter, or `variant.<name>` for each of several.",
        )
    if any(not name.strip() or name == "variant." for name in names):
        problems.add("a column has no name", "Name it, or remove it.")
    unfit = [name for name in names if not is_printable(name)]
    if unfit:
        problems.add(
            f"the name of column {unfit[0][:40]!r} has control characters or over "
            f"{LONGEST_NAME} characters",
            "Give it a short name of letters and digits.",
        )
    if all(_is_parameter(name) or name in _KEYS for name in names):
        problems.add("there is no feature column", "Log at least one feature per control step.")


def _empty() -> Table:
    nothing = Coded(distinct=np.empty(0, np.int64), code=np.empty(0, np.int32))
    return Table(
        parameters=("variant",),
        feature_names=(),
        variant=Coded(distinct=np.empty((0, 1)), code=nothing.code),
        network=nothing,
        trial=nothing,
        success=np.empty(0, np.bool_),
        features=np.empty((0, 0)),
        axes=(),
        varied=False,
        identified=False,
    )
