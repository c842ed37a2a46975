"""Buffers of past experience as arrays by name: only what is filled, no pickle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from stable_baselines3.common.buffers import BaseBuffer

from surmount.core.errors import InputError
from surmount.learn.snapshot import Tensors

PLACE = ("pos", "full")


def take_experience(buffer: BaseBuffer) -> Tensors:
    """Return copies of the rows that a buffer holds, and where the next one goes."""
    rows = _rows(buffer)
    tensors = {
        name: np.array(array[:rows] if per_row else array)
        for name, array, per_row in _arrays(buffer)
    }
    return tensors | {name: np.array(int(getattr(buffer, name))) for name in PLACE}


def put_experience(tensors: Mapping[str, np.ndarray], buffer: BaseBuffer) -> None:
    """Give a buffer what :func:`take_experience` returned.

    Raises
    ------
    InputError
        If it was of another kind, or of a longer buffer.
    """
    buffer.pos, buffer.full = int(tensors["pos"]), bool(tensors["full"])
    try:
        for name, array, _ in _arrays(buffer):
            array[: len(tensors[name])] = tensors[name]
    except (KeyError, ValueError) as error:
        raise InputError(
            f"The replay buffer does not fit the learner ({error}).",
            remedy="Go on with the learner, its `buffer_size` and the number of environments that "
            "it began with.",
        ) from error


def keeps_infos(buffer: BaseBuffer) -> bool:
    """Whether a buffer holds objects that have no place in arrays: infos that HER copies."""
    return bool(getattr(buffer, "copy_info_dict", False))


def _rows(buffer: BaseBuffer) -> int:
    # A memory-efficient buffer keeps the newest next observation in the row after.
    return buffer.buffer_size if buffer.full else min(buffer.buffer_size, buffer.pos + 1)


def _arrays(buffer: BaseBuffer) -> Iterator[tuple[str, np.ndarray, bool]]:
    """Return a buffer's arrays of numbers by name, and whether they have a row per step."""
    for name, value in vars(buffer).items():
        parts: dict[str, Any] = (
            {f"{name}/{key}": part for key, part in value.items()}
            if isinstance(value, dict)
            else {name: value}
        )
        for part_name, part in parts.items():
            if isinstance(part, np.ndarray) and part.dtype != object and part.ndim > 0:
                yield part_name, part, len(part) == buffer.buffer_size
