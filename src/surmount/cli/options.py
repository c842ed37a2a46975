"""Options that several verbs share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import tyro

from surmount.core.configuration import read_overrides
from surmount.core.errors import ConfigError

Assignments = Annotated[
    tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="KEY=VALUE")
]
"""Values of an option given any number of times; none of them may get lost."""

ConfigFile = Annotated[Path | None, tyro.conf.arg(metavar="FILE")]
"""A file of configuration keys."""


Task = Annotated[str | None, tyro.conf.arg(metavar="TASK")]
"""A registered family of tasks, or ``module:function``."""

Preset = Annotated[str, tyro.conf.arg(metavar="{smoke,paper}")]
"""A preset of the configuration."""


def overrides(file: Path | None, assignments: Sequence[str]) -> dict[str, Any]:
    """Return the overrides of a file and, over them, those given as ``key=value``."""
    changes = read_overrides(file) if file is not None else {}
    for assignment in assignments:
        key, equals, value = assignment.partition("=")
        if not equals or not key.strip():
            raise ConfigError(
                f"`--set {assignment}` is not an assignment.",
                remedy="Write it as key=value, for example learner.learning_rate=1e-4.",
            )
        changes[key.strip()] = value.strip()
    return changes


def environment_overrides(
    file: Path | None, assignments: Sequence[str], *, whole_file: bool = False
) -> dict[str, Any]:
    """Return overrides for a verb that takes nothing but the environment from a configuration.

    Parameters
    ----------
    file, assignments
        As :func:`overrides` takes them.
    whole_file
        Whether the file may be the whole configuration of a run, of which the rest is passed over.

    Raises
    ------
    ConfigError
        If another key is given: it would do nothing.
    """
    refused = overrides(None if whole_file else file, assignments)
    idle = [key for key in refused if key not in ("env", "task") and not key.startswith("env.")]
    if idle:
        raise ConfigError(
            f"`{idle[0]}` would do nothing here: only the environment's own keys count.",
            remedy="Give keys that begin with `env.`; how to try is said by options such as "
            "--repetitions and --seed.",
        )
    return overrides(file, assignments)
