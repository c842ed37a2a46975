"""The plan of a comparison of teachers: tasks, teachers, budgets and numbers, from a file."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from surmount.core.configuration import override
from surmount.core.errors import ConfigError, InputError
from surmount.core.records import read_bytes
from surmount.experiment.config import ExperimentConfig, fingerprinted
from surmount.experiment.presets import configured, preset
from surmount.teachers.catalogue import TeachersConfig, find_teacher

REFERENCE = "uniform"
"""The teacher that all others are compared with."""
ORACLE = "oracle"
"""Half of the tasks from the hard third: what tells whether there is anything to win."""
Role = Literal["held out", "tuning", "anchor"]
Towards = Literal["range", "target"]
_REMEDY = "See docs/results/teachers/plan.md for the form."


@dataclass(frozen=True, kw_only=True)
class TaskPlan:
    """One task of a comparison.

    Attributes
    ----------
    name
        The family's.
    label
        The task's and its setting's, the beginning of the names of its stages.
    role
        Whether teachers are judged or tuned on it, or a published value is looked for.
    towards
        What is wanted in the end, and judged: the whole range, or the family's target tasks.
    lots
        Names of teachers in the catalogue, the reference first. All networks of a lot are run
        before those of the next.
    networks, pilot
        Networks in all, and of the pilot, on which headroom and spread are judged.
    budget_steps
        Learning steps after the initiation, of which teachers with groups pay their trials.
    config
        The experiment that initiation, trials, learner and tests are taken from.
    teaching
        Settings of the teachers.
    """

    name: str
    label: str
    role: Role
    towards: Towards
    lots: tuple[tuple[str, ...], ...]
    networks: int
    pilot: int
    budget_steps: int
    config: ExperimentConfig
    teaching: TeachersConfig

    @property
    def teachers(self) -> tuple[str, ...]:
        """Names of all teachers, lot after lot."""
        return tuple(name for lot in self.lots for name in lot)


def read_plan(path: Path) -> tuple[TaskPlan, ...]:
    """Read a TOML file with a table ``task`` for each task, and ``teaching`` for all.

    Each ``[[task]]`` holds ``name``, ``role``, ``teachers`` (names, or lists of names: lots that
    run one after the other), ``networks``, ``pilot``, ``budget_steps``, a table ``common`` of
    dotted keys to change in the paper's preset, and, if wanted, ``towards`` (``"range"`` or
    ``"target"``) and ``settings``, a list of tables of dotted keys that are each tried as a task of
    their own. ``[teaching]`` holds dotted keys of the teachers' settings for all.

    Raises
    ------
    InputError
        If the file is not of this form.
    ConfigError
        If a name or key is unknown, or a value cannot be used.
    """
    try:
        record = tomllib.loads(read_bytes(path).decode("utf-8"))
        tables: list[dict[str, Any]] = list(record["task"])
        common = dict(record.get("teaching", {}))
        plans = tuple(
            _task(table, override(TeachersConfig(), {**common, **setting}), index)
            for table in tables
            for index, setting in enumerate(table.get("settings", [{}]))
        )
    except (OSError, UnicodeDecodeError, ValueError, KeyError, AttributeError, TypeError) as error:
        raise InputError(
            f"{path} does not describe a comparison of teachers ({type(error).__name__}: {error}).",
            remedy=_REMEDY,
        ) from error
    if not plans:
        raise InputError(f"{path} names no task.", remedy=_REMEDY)
    return plans


def _task(table: Mapping[str, Any], teaching: TeachersConfig, setting: int) -> TaskPlan:
    towards: Any = table.get("towards", "range")
    name, role, common = str(table["name"]), table["role"], dict(table.get("common", {}))
    networks, pilot = int(table["networks"]), int(table["pilot"])
    budget = int(table["budget_steps"])
    if role not in get_args(Role):
        raise ConfigError(
            f"`role` of {name} is {role!r}.", remedy=f"Choose among {', '.join(get_args(Role))}."
        )
    if towards not in get_args(Towards):
        raise ConfigError(
            f"`towards` of {name} is {towards!r}.", remedy="Choose 'range' or 'target'."
        )
    if not 2 <= pilot <= networks or budget < 1:
        raise ConfigError(
            f"{name} has {networks} networks, a pilot of {pilot} and {budget} steps.",
            remedy="Let the pilot have at least 2 networks, not more than there are, and steps.",
        )
    lots = _lots(table["teachers"])
    config = configured(preset(name, "paper"), {**common, "networks": networks})
    label = config.task if towards == "range" else f"{config.task}-{towards}"
    if len(table.get("settings", [])) > 1:
        label = f"{label}-setting-{setting}"
    return TaskPlan(
        name=config.task,
        label=label,
        role=role,
        towards=towards,
        lots=lots,
        networks=networks,
        pilot=pilot,
        budget_steps=budget,
        config=fingerprinted(config),
        teaching=teaching,
    )


def _lots(teachers: Sequence[Any]) -> tuple[tuple[str, ...], ...]:
    """Return lots of teachers, the reference first of all and none twice."""
    lots = teachers if teachers and not isinstance(teachers[0], str) else [teachers]
    placed = {REFERENCE: 0}
    for index, lot in enumerate(lots):
        for teacher in lot:
            find_teacher(teacher)
            placed.setdefault(teacher, index)
    return tuple(
        tuple(name for name, place in placed.items() if place == index)
        for index in sorted(set(placed.values()))
    )
