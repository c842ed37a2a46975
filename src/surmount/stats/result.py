"""Base of every statistical result: named fields in memory, plain JSON on disk."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import TypeAlias

import numpy as np

JsonValue: TypeAlias = "bool | int | float | str | list[JsonValue] | dict[str, JsonValue] | None"


class Result:
    """A frozen dataclass whose undefined numbers are ``None``, explained by a ``reason`` field."""

    def to_record(self) -> dict[str, JsonValue]:
        """Return the JSON form: one entry per field, nested results included, never NaN."""
        if not dataclasses.is_dataclass(self):
            raise TypeError(f"{type(self).__name__} must be a dataclass to have a JSON form")
        return {
            field.name: json_value(getattr(self, field.name)) for field in dataclasses.fields(self)
        }


def json_value(value: object) -> JsonValue:
    """Return a value of a result as plain JSON.

    Raises
    ------
    ValueError
        If a number is not finite: that is an error of ours, since results hold ``None`` there.
    """
    if isinstance(value, Result):
        return value.to_record()
    if isinstance(value, np.ndarray | np.generic):
        return json_value(value.tolist())
    if isinstance(value, tuple | list):
        return [json_value(item) for item in value]
    if isinstance(value, Mapping):
        return {str(key): json_value(item) for key, item in value.items()}
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("A statistical result holds a number that is not finite.")
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"A statistical result holds a {type(value).__name__}, which has no JSON form.")
