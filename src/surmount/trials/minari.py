"""Data sets of Minari: one group of arrays per episode, in HDF5.

Its format: ``data/main_data.hdf5`` with ``episode_<n>`` holding ``observations``, ``actions``,
``rewards``, ``terminations``, ``truncations`` and ``infos``; observations, and infos where they are
logged at the reset as well, have one entry more than there are steps, and the first is the reset's.
https://minari.farama.org/content/dataset_standards/
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from surmount.core.errors import InputError, MissingExtraError
from surmount.trials.columns import Columns
from surmount.trials.frame_columns import as_text
from surmount.trials.source import Source

_DATA = Path("data") / "main_data.hdf5"
_EPISODE = "episode_"
_COUNTERS = ("id", "total_steps", "seed")
"""What says nothing of an episode's task."""


def is_minari(path: Path) -> bool:
    """Whether a folder is a data set of Minari."""
    return (path / _DATA).is_file()


def open_minari(path: Path, columns: Columns) -> Source:
    """Open a data set: each step is a row, each entry of an observation or action a column.

    The episode's number is ``episode``; an observation is the one that its step led to; ``infos``
    are there as ``infos.<name>``, what was said of an episode as ``episode.<name>``. Text is left
    out, with a note, where ``columns`` does not name it.

    Raises
    ------
    InputError
        If it is damaged, or episodes do not hold the same.
    MissingExtraError
        If the extra ``minari`` is not installed.
    """
    try:
        import h5py  # noqa: PLC0415 - an extra, only where such a data set is opened
    except ImportError as error:
        raise MissingExtraError(
            "Minari data sets are HDF5 files, which need h5py.",
            remedy='Install it with `pip install "surmount[minari]"`.',
        ) from error
    file: Any
    try:
        with h5py.File(path / _DATA, "r") as file:
            names = [name for name in file if name.startswith(_EPISODE)]
            names.sort(key=lambda name: int(name.removeprefix(_EPISODE)))
            frames = [_episode(file[name], int(name.removeprefix(_EPISODE))) for name in names]
    except (OSError, KeyError, ValueError, TypeError) as error:
        raise InputError(
            f"{path} cannot be read as a Minari data set: it is damaged, or of another version.",
            remedy="Download or record it again.",
        ) from error
    if not frames:
        raise InputError(f"{path} holds no episodes.", remedy="Record at least one episode.")
    odd = [i for i, frame in enumerate(frames) if frame.schema != frames[0].schema]
    if odd:
        raise InputError(
            f"{path}: {names[odd[0]]} does not hold the same as {names[0]}.",
            remedy="Use a data set of one environment.",
        )
    text = [
        name
        for name, kind in frames[0].schema.items()
        if kind == pl.String and name not in columns.named
    ]
    notes = (f"{', '.join(f'`{name}`' for name in text)}: text, left out.",) if text else ()
    return Source(name=str(path), frame=pl.concat(frames).drop(text).lazy(), notes=notes)


def _episode(group: Any, number: int) -> pl.DataFrame:
    n_steps = int(group["rewards"].shape[0])
    columns: dict[str, np.ndarray[Any, Any]] = {"episode": np.full(n_steps, number)}
    for name, value in group.attrs.items():
        if name not in _COUNTERS:
            entries = np.tile(np.ravel(value), (n_steps, 1))
            _add_values(columns, f"episode.{name}", entries, alone=entries.shape[1] == 1)
    for name in group:
        _add(columns, name, group[name], n_steps)
    return pl.DataFrame(columns)


def _add(columns: dict[str, np.ndarray[Any, Any]], name: str, node: Any, n_steps: int) -> None:
    if hasattr(node, "keys"):
        for inner in node:
            _add(columns, f"{name}.{inner}", node[inner], n_steps)
        return
    values = np.asarray(node[()])
    if values.ndim and values.shape[0] >= n_steps:
        steps = values[-n_steps:].reshape(n_steps, -1)
        _add_values(columns, name, steps, alone=values.ndim == 1)


def _add_values(
    columns: dict[str, np.ndarray[Any, Any]],
    name: str,
    values: np.ndarray[Any, Any],
    *,
    alone: bool,
) -> None:
    """Add values, shape ``(step, entry)``, if they are numbers or text: a column for each entry.

    The column of an entry that is ``alone`` has the name without a number.
    """
    if values.dtype.kind in "SO":
        if not all(isinstance(entry, bytes | str) for entry in values.flat):
            return
        values = np.array([as_text(entry) for entry in values.flat]).reshape(values.shape)
    if values.dtype.kind in "biufU":
        for place, column in enumerate(values.T):
            columns[name if alone else f"{name}.{place}"] = column
