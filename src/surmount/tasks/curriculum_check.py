"""What makes a curriculum record valid: every problem as a phrase that names its place."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, cast

import numpy as np

from surmount.core.axis import CONTINUOUS, Axes, Axis, AxisKind, axes_from_record
from surmount.core.errors import InputError
from surmount.core.names import is_printable
from surmount.tasks.group_places import place_problems

SCHEMA = 1
SCHEMA_OF_AXES = 2
"""Of curricula with an axis that is not continuous, which earlier versions would misread."""
KEYS = ("kind", "schema", "parameters", "success_threshold", "groups", "levels")
AXIS_KEYS = ("kind", "names")
GROUP_KEYS = ("name", "success_rate", "variants", "boxes")
BOX_KEYS = ("lower", "upper", "weight")
LEVEL_KEYS = ("dominant", "weights")
_SUM_TOLERANCE = 1e-6
"""Weights written by hand with six digits must pass."""
_SMALLEST_WEIGHT = 1e-12
"""Positive weights are at least this share: products of smaller ones vanish, nothing is drawn."""


def curriculum_problems(record: Mapping[str, Any]) -> list[str]:
    """Return all problems of a curriculum's JSON form, an empty list if there is none."""
    if record.get("kind") != "surmount curriculum":
        return ['`kind` is not "surmount curriculum"']
    schema = record.get("schema")
    if schema not in (SCHEMA, SCHEMA_OF_AXES):
        return [f"`schema` is {schema!r}, this version reads {SCHEMA} and {SCHEMA_OF_AXES}"]
    known = (*KEYS, "axes") if schema == SCHEMA_OF_AXES else KEYS
    problems = _unknown_keys(record, "the file", known)
    parameters = record.get("parameters")
    if not _is_list(parameters, _is_name) or not parameters:
        return ["`parameters` is not a list of names"]
    if len(set(parameters)) < len(parameters):
        problems.append("`parameters` names one twice")
    about_axes = _axes_problems(record.get("axes", {}), parameters)
    if about_axes:
        return [*problems, *about_axes]
    axes = axes_from_record(record.get("axes", {}), parameters)
    if not _is_number(record.get("success_threshold"), 0, 1):
        problems.append("`success_threshold` is not a number from 0 to 1")
    groups: Any = record.get("groups")
    levels: Any = record.get("levels")
    if not _is_list(groups, _is_object) or not groups:
        return [*problems, "`groups` is not a list of groups"]
    about_groups: list[str] = []
    for index, group in enumerate(groups):
        about_groups += _group_problems(group, f"groups[{index}]", axes)
    problems += about_groups or place_problems(groups, axes)
    names = [group.get("name") for group in groups if _is_name(group.get("name"))]
    if len(set(names)) < len(names):
        problems.append("two groups have the same name")
    if not _is_list(levels, _is_object):
        return [*problems, "`levels` is not a list of levels (an empty list means none)"]
    for index, level in enumerate(levels):
        problems += _level_problems(level, f"levels[{index}]", names)
    return problems


def _unknown_keys(record: Mapping[str, Any], place: str, known: tuple[str, ...]) -> list[str]:
    """Name keys that a curriculum has no room for: saving it again would lose them."""
    return [
        f"{place} has a key {key!r}, which is none of {', '.join(known)}"
        for key in record
        if key not in known
    ]


def _axes_problems(axes: object, parameters: list[str]) -> list[str]:
    if not isinstance(axes, Mapping):
        return ["`axes` is not a table of parameters and kinds"]
    problems: list[str] = []
    for name, axis in cast(Mapping[str, Any], axes).items():
        if name not in parameters:
            problems.append(f"`axes` names {name!r}, which is no parameter")
        elif not isinstance(axis, Mapping):
            problems.append(f"`axes.{name}` is not a table with `kind`")
        else:
            record = cast(Mapping[str, Any], axis)
            problems += _unknown_keys(record, f"`axes.{name}`", AXIS_KEYS)
            names = record.get("names", [])
            if not _is_list(names, _is_name):
                problems.append(f"`axes.{name}.names` is not a list of names")
                continue
            try:
                Axis(kind=cast(AxisKind, record.get("kind")), names=tuple(names))
            except InputError as error:
                problems.append(f"`axes.{name}`: {error.message.rstrip('.')}")
    return problems


def _group_problems(group: Mapping[str, Any], place: str, axes: Axes) -> list[str]:
    problems = _unknown_keys(group, f"`{place}`", GROUP_KEYS)
    demand = _demand(axes)

    def is_point(value: object) -> bool:
        return (
            isinstance(value, list)
            and len(value) == len(axes)
            and all(
                (axis.categorical or _is_number(one))
                and bool(axis.holds(np.asarray(axis.stored(one))))
                for axis, one in zip(axes, cast(list[object], value), strict=True)
            )
        )

    if not _is_name(group.get("name")):
        problems.append(f"`{place}.name` is not a name")
    if not _is_number(group.get("success_rate"), 0, 1):
        problems.append(f"`{place}.success_rate` is not a number from 0 to 1")
    if not _is_list(group.get("variants"), is_point) or not group.get("variants"):
        problems.append(f"`{place}.variants` is not a list of lists of {demand}")
    boxes = group.get("boxes")
    if not _is_list(boxes, _is_object) or not boxes:
        return [*problems, f"`{place}.boxes` is not a list of boxes"]
    sound = True
    for index, box in enumerate(boxes):
        where = f"{place}.boxes[{index}]"
        problems += _unknown_keys(box, f"`{where}`", BOX_KEYS)
        lower, upper = box.get("lower"), box.get("upper")
        if not (is_point(lower) and is_point(upper)):
            problems.append(f"`{where}` lacks `lower` and `upper` with {demand} each")
        elif any(
            axis.stored(low) > axis.stored(high)
            for axis, low, high in zip(axes, lower, upper, strict=True)
        ):
            problems.append(f"`{where}` has a lower bound above its upper bound")
        if not _is_number(box.get("weight"), 0, math.inf):
            problems.append(f"`{where}.weight` is not a number of at least 0")
            sound = False
    total = sum(box["weight"] for box in boxes) if sound else 1.0
    if total <= 0:
        problems.append(f"`{place}.boxes` have no weight")
    elif sound and any(_vanishes(box["weight"], max(1.0, total)) for box in boxes):
        problems.append(f"`{place}.boxes` have {_TOO_SMALL}")
    return problems


def _demand(axes: Axes) -> str:
    """Return what a point consists of, for sentences."""
    if all(axis == CONTINUOUS for axis in axes):
        return f"{len(axes)} numbers"
    return f"{len(axes)} values ({'; '.join(axis.demand for axis in axes)})"


def _level_problems(level: Mapping[str, Any], place: str, names: list[Any]) -> list[str]:
    problems = _unknown_keys(level, f"`{place}`", LEVEL_KEYS)
    weights = level.get("weights")
    if level.get("dominant") not in names:
        problems.append(f"`{place}.dominant` is {level.get('dominant')!r}, which is no group")
    if not isinstance(weights, Mapping):
        return [*problems, f"`{place}.weights` is not a table of group names and weights"]
    unknown = [str(name) for name in weights if name not in names]
    if unknown:
        problems.append(f"`{place}.weights` names {', '.join(unknown)}, which is no group")
    if not all(_is_number(weight, 0, 1) for weight in weights.values()):
        problems.append(f"`{place}.weights` are not all numbers from 0 to 1")
    elif abs(sum(weights.values()) - 1.0) > _SUM_TOLERANCE:
        problems.append(f"`{place}.weights` sum to {sum(weights.values()):g}, not to 1")
    elif any(_vanishes(weight, 1.0) for weight in weights.values()):
        problems.append(f"`{place}.weights` have {_TOO_SMALL}")
    elif level.get("dominant") in names and not weights.get(level["dominant"]):
        problems.append(f"`{place}.dominant` is {level['dominant']!r}, whose weight is 0")
    return problems


_TOO_SMALL = f"a weight between 0 and {_SMALLEST_WEIGHT:g} of all: give 0, or more"


def _vanishes(weight: float, total: float) -> bool:
    return 0 < weight < _SMALLEST_WEIGHT * total


def _is_number(value: object, low: float = -math.inf, high: float = math.inf) -> bool:
    return (
        isinstance(value, int | float)
        and not isinstance(value, bool)
        and abs(value) < 1e300  # integers beyond float range come from JSON as well
        and low <= value <= high
    )


def _is_name(value: object) -> bool:
    return isinstance(value, str) and bool(value.strip()) and is_printable(value)


def _is_object(value: object) -> bool:
    return isinstance(value, Mapping)


def _is_list(value: object, item: Callable[[Any], bool]) -> bool:
    return isinstance(value, list) and all(item(element) for element in value)
