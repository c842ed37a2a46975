"""``surmount tasks``: the registered families of tasks."""

from __future__ import annotations

from typing import Annotated

import tyro

from surmount.core.configuration import dotted_keys
from surmount.envs.family import TaskFamily
from surmount.envs.registry import find_family, registered_families


def tasks(name: Annotated[str | None, tyro.conf.Positional] = None) -> int:
    """List the registered tasks with parameters, ranges and units; with a name, all of one.

    Args:
        name: A registered task, or an environment of your own as my_module:make_env.
    """
    if name is not None:
        family = find_family(name)
        print("\n".join([*_described(family), *_details(family)]))
        return 0
    for family in registered_families().values():
        print("\n".join([*_described(family), ""]))
    print("An environment of your own is named as my_module:make_env (see `surmount check`).")
    return 0


def _described(family: TaskFamily) -> list[str]:
    space = family.space(family.settings())
    lines = [f"{family.name}: {family.title}"]
    for index, parameter in enumerate(space.parameters):
        harder = ""
        if space.harder is not None:
            harder = f", {'larger' if space.harder[index] > 0 else 'smaller'} is harder"
        lines.append(f"  {parameter} from {space.lower[index]:g} to {space.upper[index]:g}{harder}")
    lines.append(f"  {len(space.variants)} variants")
    return lines


def _details(family: TaskFamily) -> list[str]:
    space = family.space(family.settings())
    variants = [", ".join(f"{value:g}" for value in variant) for variant in space.variants]
    keys = [f"env.{key}" for key in dotted_keys(family.settings)]
    return [
        f"  {'; '.join(variants)}",
        "settings:" if keys else "no settings of its own",
        *(f"  {key}" for key in keys),
    ]
