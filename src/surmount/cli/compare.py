"""``surmount compare``: teachers at matched budgets, over networks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import tyro

from surmount.cli.configuration_flags import RunOptions, opened_console, run_configured
from surmount.cli.main import INTERRUPTED
from surmount.core.configuration import differences, to_record
from surmount.core.errors import ConfigError
from surmount.experiment.config import ExperimentConfig
from surmount.teachers.catalogue import SETTINGS, TEACHERS, TeachersConfig
from surmount.workflow.run_layout import COMPARISON, COMPARISON_FILE

DEFAULT = ("paper", "uniform", "easy-to-hard", "parameter-distance", "alp-gmm", "plr")
TEACHING = "teaching"
"""Prefix of the keys of teachers' own settings."""


@dataclass(frozen=True, kw_only=True)
class Options(RunOptions):
    """Options of the verb."""

    teachers: Annotated[tuple[str, ...], tyro.conf.arg(metavar=f"{{{','.join(TEACHERS)}}}")] = (
        DEFAULT
    )
    """Names of the teachers; settings of their own begin with teaching, such as
    --teaching.plr.temperature 0.3."""


def compare(arguments: Sequence[str]) -> int:
    """Train the same initial networks on by several teachers, as long as the paper's took.

    The paper's curriculum and the uniform control are always among them. The folder is that of an
    experiment: one that `surmount reproduce` has finished with the same configuration is taken as
    it is, and calling again goes on where it stopped, also with more teachers.
    """
    return run_configured(
        Options,
        _run,
        arguments,
        verb="compare",
        description=str(compare.__doc__),
        beside={TEACHING: TeachersConfig()},
    )


def _run(options: Options, chosen: ExperimentConfig, beside: Mapping[str, Any]) -> int:
    teaching: TeachersConfig = beside[TEACHING]
    _require_used(teaching, options.teachers)
    console = opened_console(options.out)
    # After the first line: what learns takes seconds to import.
    from surmount.core.records import read_record
    from surmount.experiment.experiment import Experiment
    from surmount.report.pages import write_report
    from surmount.report.teachers_page import write_teachers_report
    from surmount.tasks.curriculum import ONE_GROUP

    experiment = Experiment(chosen, options.out)
    outcome = experiment.compare(
        options.teachers,
        settings=teaching,
        **options.workers.checked(),
        console=console,
        amend=options.resume,
    )
    if outcome.interrupted:
        console.print("Stopped. The same command goes on.")
        return INTERRUPTED
    record = read_record(outcome.artefacts[COMPARISON].path(COMPARISON_FILE))
    write_report(options.out)
    page = write_teachers_report(record, options.out)
    if len(record["groups"]) == 1:
        console.print(f"One group. {ONE_GROUP}", soft_wrap=True, markup=False)
    console.print(_table(record))
    console.print(f"Report: {page.resolve()}", soft_wrap=True)
    return 0


def _require_used(teaching: TeachersConfig, teachers: tuple[str, ...]) -> None:
    names = {part: name for name, part in SETTINGS.items()}
    for key in differences(to_record(TeachersConfig()), to_record(teaching)):
        teacher = names[key.partition(".")[0]]
        if teacher not in teachers:
            raise ConfigError(
                f"`{TEACHING}.{key}` is a setting of {teacher}, which is not among the teachers.",
                remedy=f"Add {teacher} to --teachers, or leave the setting out.",
            )


def _table(record: dict[str, Any]) -> Any:
    from rich.table import Table

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
