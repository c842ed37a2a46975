"""Dataclasses back from the JSON form that Surmount wrote, every value's type checked."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Mapping
from typing import Any, TypeVar, cast, get_args

import msgspec
import numpy as np

Read = TypeVar("Read")
_ALLOWED = {"f": "fiu", "i": "iu", "b": "b"}
"""Kinds of arrays that JSON may hold for a kind of field: whole numbers are numbers, too."""


def read_as(kind: type[Read], record: object) -> Read:
    """Return an object of a type from its JSON form.

    Parameters
    ----------
    kind
        A dataclass, or any other annotation of built-in types, dataclasses and NumPy arrays.
    record
        What JSON holds. Keys that the dataclass does not know are passed over.

    Raises
    ------
    ValueError
        If something is missing or of another type; the message names the place, as in
        ``Expected `int`, got `str` - at `$.groups[0].size```.
    """
    return msgspec.convert(record, kind, dec_hook=_array)


def read_fields(
    kind: type[object], record: Mapping[str, Any], *, built: Mapping[str, object]
) -> dict[str, Any]:
    """Return the fields of a dataclass from its JSON form, but for those that are built already.

    Raises
    ------
    ValueError
        As :func:`read_as`.
    """
    hints = typing.get_type_hints(kind)
    names = [field.name for field in dataclasses.fields(cast(Any, kind))]
    return {
        name: built[name] if name in built else _named(hints[name], record, name) for name in names
    }


def _named(hint: Any, record: Mapping[str, Any], name: str) -> Any:
    try:
        return read_as(hint, record[name])
    except KeyError:
        raise ValueError(f"`{name}` is missing") from None
    except ValueError as error:
        raise ValueError(f"`{name}`: {error}") from error


def _array(kind: Any, value: Any) -> np.ndarray[Any, Any]:
    """Return an array of the element type that a field is annotated with."""
    dtype = np.dtype(get_args(get_args(kind)[1])[0])
    array = np.asarray(value)
    if array.size and array.dtype.kind not in _ALLOWED[dtype.kind]:
        raise ValueError(f"an array of {dtype.name} holds something else")
    array = array.astype(dtype)
    if dtype.kind == "f" and not np.isfinite(array).all():
        raise ValueError("a number is not finite")
    return array
