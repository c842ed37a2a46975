"""``surmount compare``: teachers at matched budgets, over networks."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tyro
from rich.console import Console
from rich.table import Table

from surmount.cli.main import INTERRUPTED
from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.cli.reproduce import begun_with
from surmount.cli.running import run_experiment
from surmount.cli.workers import WorkerOptions, Workers
from surmount.core.configuration import override
from surmount.core.errors import ConfigError
from surmount.core.records import read_record
from surmount.core.run_layout import COMPARISON, COMPARISON_FILE
from surmount.experiment.teaching import SETTINGS, comparison_graph
from surmount.report import write_report
from surmount.report.teachers_page import write_teachers_report
from surmount.teachers import TEACHERS, TeachersConfig

DEFAULT = ("paper", "uniform", "easy-to-hard", "parameter-distance", "alp-gmm", "plr")
TEACHING = "teaching."
"""Prefix of the keys of teachers' own settings."""


def compare(
    task: Annotated[
        str | None,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="{narrow-channel,low-entrance,step,MODULE:FUNCTION}"),
    ] = None,
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")],
    teachers: Annotated[
        tuple[str, ...], tyro.conf.arg(metavar=f"{{{','.join(TEACHERS)}}}")
    ] = DEFAULT,
    seeds: Annotated[int | None, tyro.conf.arg(metavar="N")] = None,
    scale: Annotated[str, tyro.conf.arg(metavar="{smoke,paper}")] = "smoke",
    resume: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False,
    config: ConfigFile = None,
    set: Assignments = (),  # noqa: A002 - the option's name
    workers: WorkerOptions = Workers(),  # noqa: B008 - frozen
) -> int:
    """Train the same initial networks on by several teachers, as long as the paper's took.

    The paper's curriculum and the uniform control are always among them. The folder is that of an
    experiment: one that `surmount reproduce` has finished with the same configuration is taken as
    it is, and calling again goes on where it stopped, also with more teachers.

    Args:
        task: The obstacle, or an environment of your own as my_module:make_env; may be left out
            with --resume.
        out: Folder for everything the run makes.
        teachers: Names of the teachers.
        seeds: Number of independent initial networks; the preset's if not given.
        scale: smoke (minutes, shows the method at work) or paper (the paper's scale, many hours).
        resume: Take the run in --out with its stored configuration, whatever that is.
        config: TOML or JSON file of configuration keys to change; see `surmount config`.
        set: Configuration key to change, as key=value; may be repeated; overrides the file. A
            teacher's own settings begin with teaching, such as teaching.plr.temperature=0.3.
        workers: Where stages run.
    """
    changes = overrides(config, set)
    own = {key: changes.pop(key) for key in [*changes] if key.startswith(TEACHING)}
    teaching = override(_Settings(), own).teaching
    _require_used([*own], teachers)
    if seeds is not None:
        changes["networks"] = seeds
    chosen = override(begun_with(task, scale, out, resume=resume), changes)
    graph = comparison_graph(chosen, teachers, teaching)
    console = Console()
    outcome = run_experiment(out, chosen, graph, workers, console)
    if outcome.interrupted:
        console.print("Stopped. The same command goes on.")
        return INTERRUPTED
    record = read_record(outcome.artefacts[COMPARISON].path(COMPARISON_FILE))
    write_report(out)
    page = write_teachers_report(record, out)
    console.print(_table(record))
    console.print(f"Report: {page.resolve()}", soft_wrap=True)
    return 0


@dataclass(frozen=True, kw_only=True)
class _Settings:
    """Teachers' settings under the name that the command line gives them."""

    teaching: TeachersConfig = field(default_factory=TeachersConfig)


def _require_used(keys: list[str], teachers: tuple[str, ...]) -> None:
    names = {part: name for name, part in SETTINGS.items()}
    for key in keys:
        teacher = names[key.removeprefix(TEACHING).partition(".")[0]]
        if teacher not in teachers:
            raise ConfigError(
                f"`{key}` is a setting of {teacher}, which is not among the teachers.",
                remedy=f"Add {teacher} to --teachers, or leave the setting out.",
            )


def _table(record: dict[str, Any]) -> Table:
    table = Table(title="Success over networks", title_justify="left")
    for column in ("teacher", "interquartile mean", *record["groups"]):
        table.add_column(column)
    for teacher in record["teachers"]:
        whole = teacher["interquartile_mean"]
        interval = (
            "" if whole["lower"] is None
            else f" ({100 * whole['lower']:.0f} to {100 * whole['upper']:.0f})"
        )  # fmt: skip
        table.add_row(
            teacher["title"],
            f"{100 * whole['estimate']:.0f} %{interval}",
            *(f"{100 * group['estimate']:.0f} %" for group in teacher["mean_by_group"]),
        )
    return table
