"""``surmount tasks``: the registered families of tasks, or all about one."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

import tyro

from surmount.cli.options import Task
from surmount.core.configuration import dotted_keys, to_record
from surmount.core.errors import SurmountError
from surmount.core.printing import say
from surmount.envs.family import TaskFamily
from surmount.envs.registry import find_family, registered_families
from surmount.tasks.space import TaskSpace, describe_range

WIDTH = 80
"""Columns of a terminal that nobody has widened."""
HARDER = {1: "larger is harder", -1: "smaller is harder"}


def tasks(task: Annotated[Task, tyro.conf.Positional] = None) -> int:
    """List the registered tasks with their parameters, ranges, units, variants and difficulty.

    Args:
        task: Show one: its variants, and the keys of its settings with their values; also an
            environment of your own, as my_module:make_env.
    """
    if task is not None:
        say("\n".join(_described(find_family(task))))
        return 0
    families = registered_families()
    for name, family in families.items():
        say("\n".join(_listed(name, family)))
    say(f"{len(families)} tasks are registered; `surmount tasks NAME` tells more of one.")
    return 0


def _listed(name: str, family: TaskFamily) -> Iterator[str]:
    yield f"{name}: {family.title}"
    try:
        yield from _space_lines(family.space(family.settings()))
    except SurmountError as error:  # of a package's environment; the other tasks are none the less
        yield from _wrapped(f"{error.message} {error.remedy}")
    yield ""


def _described(family: TaskFamily) -> Iterator[str]:
    settings = family.settings()
    space = family.space(settings)
    yield f"{family.name}: {family.title}"
    yield from _space_lines(space)
    yield from _wrapped(f"initiation at the paper's scale: {family.initial_steps:,} learning steps")
    yield ""
    yield "variants"
    yield from _wrapped(", ".join(space.text(variant) for variant in space.variants))
    yield ""
    keys = dotted_keys(family.settings)
    record = to_record(settings)
    yield "settings, to be changed by --set or as flags" if keys else "no settings of its own"
    for key in keys:
        yield from _wrapped(f"env.{key} = {json.dumps(_value(record, key))}")


def _space_lines(space: TaskSpace) -> Iterator[str]:
    for index, parameter in enumerate(space.parameters):
        harder = HARDER[space.harder[index]] if space.harder else "nobody says what is harder"
        span = f"{describe_range(space, index)}{_unit(parameter)}"
        yield from _wrapped(span if space.axes[index].categorical else f"{span}; {harder}")
    count = len(space.variants)
    yield f"  {count} variant{'s' if count != 1 else ''}"


def _unit(parameter: str) -> str:
    """Return the unit that a parameter's name ends in, after a space; nothing without one."""
    from surmount.report.document.text import name_and_unit

    unit = name_and_unit(parameter)[1]
    return f" {unit}" if unit else ""


def _value(record: Mapping[str, Any], key: str) -> Any:
    value: Any = record
    for part in key.split("."):
        value = value[part]
    return value


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(
        text, WIDTH, initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False
    )
