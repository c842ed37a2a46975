"""Families of tasks by name: those of installed packages, and anybody's ``module:function``.

A package registers its families by an entry point of the group ``surmount.tasks``, whose object
maps names to families, or to functions that make a :class:`~surmount.envs.task_env.TaskEnv`::

    [project.entry-points."surmount.tasks"]
    mine = "my_package.tasks:FAMILIES"     # {"hill": make_hill} is found as mine/hill
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from importlib.metadata import EntryPoint, entry_points
from typing import Any, cast

from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError
from surmount.core.extras import missing_extra
from surmount.envs.family import TaskFamily

GROUP = "surmount.tasks"
"""Entry points that register families."""


def find_family(name: str) -> TaskFamily:
    """Return the family of a name.

    Parameters
    ----------
    name
        A registered name such as ``"rstar/step"``, its last part where no other family has the
        same, or ``"module:function"``.

    Raises
    ------
    ConfigError
        If there is none.
    InputError
        If a module fails while it is imported.
    """
    if ":" in name:
        return _own_family(name)
    families = registered_families()
    if name in families:
        return families[name]
    alike = [known for known in families if known.rpartition("/")[2] == name]
    if len(alike) == 1:
        return families[alike[0]]
    if alike:
        raise ConfigError(
            f"`{name}` is the name of several tasks.", remedy=f"Give {' or '.join(alike)}."
        )
    choices = [*families, *(known.rpartition("/")[2] for known in families)]
    raise ConfigError(
        f"There is no task `{name}`.",
        remedy=f"{nearest(name, choices)} `surmount tasks` lists those that are registered; an "
        "environment of your own is named as my_module:make_env.",
    )


@functools.cache
def registered_families() -> Mapping[str, TaskFamily]:
    """Return the families of all installed packages by name, in alphabetical order.

    Raises
    ------
    ConfigError
        If a package registers something else.
    """
    found: dict[str, TaskFamily] = {}
    for entry in entry_points(group=GROUP):
        for name, family in _families_of(entry).items():
            found[f"{entry.name}/{name}"] = family
    return dict(sorted(found.items()))


def _families_of(entry: EntryPoint) -> dict[str, TaskFamily]:
    registered = entry.load()
    if not isinstance(registered, Mapping):
        raise _unusable(entry, "no mapping of names")
    families: dict[str, TaskFamily] = {}
    for name, value in cast(Mapping[object, object], registered).items():
        if isinstance(value, TaskFamily):
            families[str(name)] = value
        elif callable(value):
            try:
                families[str(name)] = _own_family(f"{entry.name}/{name}", value)
            except ModuleNotFoundError as error:
                if missing_extra(error) is None:
                    raise
                # Nobody can run it here; who only reads what runs have left does not miss it.
        else:
            raise _unusable(entry, f"{type(value).__name__} under `{name}`")
    return families


def _own_family(name: str, make_env: Callable[..., Any] | None = None) -> TaskFamily:
    # Needs Gymnasium, which those do without who only read what runs have left.
    from surmount.envs.loading import load_make_env  # noqa: PLC0415
    from surmount.envs.own_family import OwnFamily  # noqa: PLC0415

    return OwnFamily(name, load_make_env(name) if make_env is None else make_env)


def _unusable(entry: EntryPoint, what: str) -> ConfigError:
    return ConfigError(
        f"The entry point `{entry.name}` of the group {GROUP} ({entry.value}) holds {what}.",
        remedy="Let it hold a mapping from names to families of tasks or to functions that make "
        "a TaskEnv, or uninstall its package.",
    )
