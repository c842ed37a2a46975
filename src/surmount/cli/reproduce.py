"""``surmount reproduce``: the whole protocol of the paper on one obstacle."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Annotated

import tyro
from rich.console import Console

from surmount.cli.display import RunDisplay
from surmount.cli.films import films
from surmount.cli.main import INTERRUPTED
from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.cli.summary import print_summary
from surmount.cli.workers import WorkerOptions, Workers
from surmount.core.configuration import override
from surmount.core.errors import ConfigError
from surmount.core.store import sole_user
from surmount.experiment import (
    ExperimentConfig,
    GraphRunner,
    begin,
    load_config,
    preset,
    protocol,
    refuse_other,
    run,
)
from surmount.report import write_report


def reproduce(
    obstacle: Annotated[
        str | None,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="{narrow-channel,low-entrance,step,MODULE:FUNCTION}"),
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
        obstacle: The obstacle, or an environment of your own as my_module:make_env (see `surmount
            check`); may be left out with --resume.
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
    chosen = override(begun_with(obstacle, preset, out, resume=resume), changes)
    graph = protocol(chosen)
    workers.check()
    refuse_other(out, chosen)
    console = Console()
    with sole_user(out):
        begin(out, chosen)
        with RunDisplay(console, out / "logs" / "run.log") as display:
            executor = workers.make(display.listen)
            try:
                with stop_on_signals(display.note) as on_ready:
                    outcome = run(
                        out,
                        chosen,
                        executor,
                        display,
                        on_ready=on_ready,
                        stages=graph,
                        url=workers.store,
                        retries=workers.retries,
                    )
            finally:
                executor.close()
    if outcome.interrupted:
        console.print(f"Stopped. Go on with: surmount reproduce --resume --out {out}")
        return INTERRUPTED
    films(out, lambda sentence: console.print(sentence, soft_wrap=True, markup=False))
    page = write_report(out)
    print_summary(console, out)
    console.print(f"Report: {page.resolve()}", soft_wrap=True)
    return 0


def begun_with(obstacle: str | None, scale: str, out: Path, *, resume: bool) -> ExperimentConfig:
    """Return the preset of an obstacle, or the configuration of the run in a folder.

    Raises
    ------
    ConfigError
        If no obstacle is given to begin with, or the run is on another one.
    OutputError
        If a run is to be resumed and there is none.
    """
    if resume:
        stored = load_config(out)
        if obstacle not in (None, stored.obstacle):
            raise ConfigError(
                f"{out} holds a run on {stored.obstacle}, not on {obstacle}.",
                remedy="Leave the obstacle out, or choose another --out folder.",
            )
        return stored
    if obstacle is None:
        raise ConfigError(
            "No obstacle was given.",
            remedy="Name narrow-channel, low-entrance or step, or my_module:make_env.",
        )
    return preset(obstacle, scale)


STOPPING = b"surmount: stopping at the next checkpoint; Ctrl-C again ends at once\n"


@contextmanager
def stop_on_signals(
    note: Callable[[str], None],
) -> Generator[Callable[[GraphRunner], None]]:
    """Let the first Ctrl-C (or SIGTERM) save and stop a runner, and the second end at once.

    Yields what is to be called with the runner; afterwards signals do what they did before, and
    that the run was asked to stop is noted. A signal may arrive within any call, also one that
    writes to the display or to the log: its handler uses neither.
    """
    runners: list[GraphRunner] = []
    asked = False

    def handle(_number: int, _frame: FrameType | None) -> None:
        nonlocal asked
        if asked:
            os._exit(INTERRUPTED)  # workers see that their parent has gone, and end too
        asked = True
        with suppress(OSError):
            os.write(2, STOPPING)
        for runner in runners:
            runner.stop()

    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, handle) for number in signals]
    try:
        yield runners.append
    finally:
        for number, previous in zip(signals, before, strict=True):
            signal.signal(number, previous)
        if asked:
            note("was asked to stop")
