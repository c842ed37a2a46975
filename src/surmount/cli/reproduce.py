"""``surmount reproduce``: the whole protocol of the paper on one obstacle."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console

from surmount.cli.films import films
from surmount.cli.main import INTERRUPTED
from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.cli.running import run_experiment
from surmount.cli.summary import print_summary
from surmount.cli.workers import WorkerOptions, Workers
from surmount.core.configuration import override
from surmount.core.errors import ConfigError
from surmount.envs.registry import find_family
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.presets import preset
from surmount.experiment.protocol import protocol
from surmount.experiment.running import load_config
from surmount.report.pages import write_report


def reproduce(
    task: Annotated[
        str | None,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="TASK"),
    ] = None,
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")],
    preset: Annotated[str, tyro.conf.arg(metavar="{smoke,paper}")] = "smoke",
    seeds: Annotated[int | None, tyro.conf.arg(metavar="N")] = None,
    resume: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False,
    config: ConfigFile = None,
    set: Assignments = (),  # noqa: A002 - the option's name
    workers: WorkerOptions = Workers(),  # noqa: B008 - frozen
) -> int:
    """Run the paper's protocol on one obstacle, from the first learning step to the report.

    Calling it again with the same options goes on where it stopped: finished stages are kept, and
    training goes on from its last checkpoint to the same result. Ctrl-C stops cleanly.

    Args:
        task: One of those that `surmount tasks` lists, or an environment of your own as
            my_module:make_env (see `surmount check`); may be left out with --resume.
        out: Folder for everything the run makes.
        preset: smoke (minutes, shows the method at work) or paper (the paper's scale, many hours).
        seeds: Number of independent initial networks; the preset's if not given.
        resume: Go on with the run in --out, with its stored configuration.
        config: TOML or JSON file of configuration keys to change; see `surmount config`.
        set: Configuration key to change, as key=value; may be repeated; overrides the file.
        workers: Where stages run.
    """
    changes = overrides(config, set)
    if seeds is not None:
        changes["networks"] = seeds
    chosen = override(begun_with(task, preset, out, resume=resume), changes)
    graph = protocol(chosen)
    console = Console()
    outcome = run_experiment(out, chosen, graph, workers, console)
    if outcome.interrupted:
        console.print(f"Stopped. Go on with: surmount reproduce --resume --out {out}")
        return INTERRUPTED
    films(out, lambda sentence: console.print(sentence, soft_wrap=True, markup=False))
    page = write_report(out)
    print_summary(console, out)
    console.print(f"Report: {page.resolve()}", soft_wrap=True)
    return 0


def begun_with(task: str | None, name: str, out: Path, *, resume: bool) -> ExperimentConfig:
    """Return the preset of a task, or the configuration of the run in a folder.

    Raises
    ------
    ConfigError
        If no task is given to begin with, or the run is on another one.
    OutputError
        If a run is to be resumed and there is none.
    """
    if resume:
        stored = load_config(out)
        if task is not None and find_family(task).name != stored.task:
            raise ConfigError(
                f"{out} holds a run on {stored.task}, not on {task}.",
                remedy="Leave the task out, or choose another --out folder.",
            )
        return stored
    if task is None:
        raise ConfigError(
            "No task was given.",
            remedy="Name narrow-channel, low-entrance or step, or my_module:make_env.",
        )
    return preset(task, name)
