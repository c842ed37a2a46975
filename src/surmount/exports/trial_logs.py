"""Trials from logs of other frameworks: CSV files with columns of their own names.

ML-Agents itself logs no behaviour within an episode; a few lines of C# write one row per step
(docs/exports.md). Columns are mapped to the table of trials, and an outcome that stands on the last
row of a trial, or on one of them, is spread over all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.errors import ConfigError, InputError
from surmount.trials.table import trials_from_table
from surmount.trials.table_file import read_columns
from surmount.trials.trials import Trials

_RESERVED = ("variant", "network", "trial", "success")
"""Columns of a table of trials that are no features."""
_TIME = "time_s"
_NUMBER_EPISODES = (
    "Number episodes anew after each reset and, where several agents write one log, by agent, as "
    "in `3:17`."
)


@dataclass(frozen=True, kw_only=True)
class Columns:
    """Which columns of a log hold what.

    Attributes
    ----------
    variant
        Column of each task parameter, by the parameter's name.
    trial
        Column of the episode's number.
    success
        Column that is not zero on a row where the goal is reached.
    features
        Column of each feature, by the feature's name; ``time_s`` is the time since the start of
        the trial.
    network
        Column of the training run; all are one if empty.
    """

    variant: Mapping[str, str]
    trial: str
    success: str
    features: Mapping[str, str]
    network: str = ""


def read_log(path: Path, columns: Columns) -> Trials:
    """Read trials from a log.

    A trial is a number of an episode in one network; it has reached its goal if any of its rows
    says so.

    Raises
    ------
    ConfigError
        If a feature has the name of something else.
    InputError
        If a column is not there, there are no rows, an episode changes its variant or its time
        runs backwards, or the table is not valid.
    """
    _check_features(columns)
    file = read_columns(path)
    if file.n_rows == 0:
        raise InputError(f"{path} has no rows.", remedy="Log at least one trial.")
    table = dict(file)  # it hands each column out once
    wanted = [*columns.variant.values(), columns.trial, columns.success,
              *columns.features.values(), *filter(None, [columns.network])]  # fmt: skip
    missing = [name for name in wanted if name not in table]
    if missing or not columns.variant or not columns.features:
        raise InputError(
            f"{path} has no column {', '.join(f'`{name}`' for name in missing)}."
            if missing
            else "No task parameter or no feature was named.",
            remedy=f"It has {', '.join(map(str, table))}.",
        )
    episode = np.asarray(table[columns.trial])
    network = np.asarray(table[columns.network]) if columns.network else np.zeros(len(episode))
    reached = _truth(table[columns.success], path, columns.success)
    pairs = np.stack([_codes(network), _codes(episode)], axis=1)
    _, own = np.unique(pairs, axis=0, return_inverse=True)
    own = own.reshape(-1)
    success = np.zeros(int(own.max()) + 1, dtype=np.bool_)
    np.logical_or.at(success, own, reached)
    found: dict[str, Any] = {
        f"variant.{name}": table[column] for name, column in columns.variant.items()
    }
    for name, values in found.items():
        first = np.asarray(values)[np.unique(own, return_index=True)[1]]
        if (first[own] != np.asarray(values)).any():
            raise InputError(
                f"{path}: `{name}` changes within an episode.",
                remedy=_NUMBER_EPISODES,
            )
    if _TIME in columns.features:
        back = _first_back(np.asarray(table[columns.features[_TIME]]), own)
        if back is not None:
            run = f" of `{columns.network}` {network[back]}" if columns.network else ""
            raise InputError(
                f"{path}: at row {back + 1} `{columns.features[_TIME]}` runs backwards, within "
                f"`{columns.trial}` {episode[back]}{run}.",
                remedy=f"{_NUMBER_EPISODES} Write the rows of an episode in the order of time.",
            )
    found |= {"network": pairs[:, 0], "trial": pairs[:, 1], "success": success[own]}
    found |= {name: table[column] for name, column in columns.features.items()}
    return trials_from_table(found, source=str(path))


def _check_features(columns: Columns) -> None:
    for name in columns.features:
        if name in _RESERVED or name.startswith("variant.") or name in columns.variant:
            what = "a task parameter" if name in columns.variant else "a column of its own"
            raise ConfigError(
                f"A feature cannot be named `{name}`, which is {what} in a table of trials.",
                remedy="Give the feature another name.",
            )


def _first_back(time: np.ndarray[Any, Any], trial: np.ndarray[Any, Any]) -> int | None:
    """Return the first row, from 0, that is earlier than the row before it in its trial."""
    if time.dtype.kind not in "iuf":
        return None  # told with the table's other problems
    order = np.argsort(trial, kind="stable")
    back = (np.diff(time[order].astype(np.float64)) < 0) & (np.diff(trial[order]) == 0)
    rows = order[1:][back]
    return int(rows.min()) if rows.size else None


def _codes(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return np.unique(values, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _truth(values: Any, path: Path, column: str) -> np.ndarray[Any, Any]:
    array = np.asarray(values)
    if array.dtype == np.bool_:
        return array
    words = {"true": True, "false": False, "1": True, "0": False, "": False}
    if array.dtype.kind in "OUS":
        lowered = [str(value).strip().lower() for value in array]
        if not set(lowered) <= words.keys():
            raise InputError(
                f"{path}: `{column}` holds other values than true and false.",
                remedy="Write 1 or true where the goal is reached, 0 or false elsewhere.",
            )
        return np.array([words[value] for value in lowered])
    return np.nan_to_num(array.astype(np.float64)) != 0
