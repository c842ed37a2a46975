"""Running an experiment in an output folder: begin it, or go on with the one that is there."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path

from surmount.core.configuration import completed, differences, from_record, nearest, to_record
from surmount.core.errors import ConfigError, OutputError
from surmount.core.records import read_record, write_record
from surmount.core.run_layout import RUN, SCHEMA
from surmount.core.store import output_errors
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.depot import Depot
from surmount.experiment.executor import Executor, Listener
from surmount.experiment.graph import Stage
from surmount.experiment.in_process import InProcessExecutor
from surmount.experiment.journal import Journal
from surmount.experiment.local_processes import ProcessExecutor
from surmount.experiment.protocol import protocol
from surmount.experiment.provenance import provenance
from surmount.experiment.runner import RETRIES, GraphRunner, RunObserver, RunOutcome


def load_config(root: Path) -> ExperimentConfig:
    """Return the configuration of the experiment in a folder.

    Raises
    ------
    OutputError
        If there is no experiment in the folder.
    """
    if not (root / RUN).is_file():
        raise OutputError(
            f"There is no experiment in {root}.",
            remedy="Give the --out folder of a run, or begin one without --resume.",
        )
    return from_record(ExperimentConfig, read_record(root / RUN)["config"])


def begin(root: Path, config: ExperimentConfig) -> None:
    """Claim a folder for an experiment, or recognise the same experiment in it.

    Raises
    ------
    OutputError
        If the folder holds an experiment with another configuration, or other files.
    """
    refuse_other(root, config)
    with output_errors(root):
        if not (root / RUN).exists():
            record = {
                "schema": SCHEMA,
                "config": to_record(config),
                **provenance(),
            }
            write_record(root / RUN, record)


def refuse_other(root: Path, config: ExperimentConfig) -> None:
    """Refuse a folder of something else, before anything is written to it.

    Raises
    ------
    OutputError
        If the folder holds an experiment with another configuration, or other files.
    """
    with output_errors(root):
        if (root / RUN).exists():
            _require_same(root, config)
        elif root.exists() and any(not path.name.startswith(".") for path in root.iterdir()):
            raise OutputError(
                f"{root} holds files that are not of an experiment.",
                remedy="Choose an --out folder that is empty or does not exist.",
            )


EXECUTORS = ("in-process", "processes", "ray")
"""Where stages can run."""


def make_executor(
    processes: int | None,
    listener: Listener,
    *,
    kind: str = "processes",
    address: str | None = None,
) -> Executor:
    """Return an executor.

    Parameters
    ----------
    processes
        Local worker processes; one per core if ``None``; 0 runs everything in this process.
    listener
        Told what stages tell.
    kind
        One of :data:`EXECUTORS`.
    address
        Of the head of a Ray cluster; Ray is started on this machine if ``None``.

    Raises
    ------
    ConfigError
        If options do not fit.
    MissingExtraError
        If Ray is asked for and not installed.
    """
    if kind not in EXECUTORS:
        raise ConfigError(f"Unknown executor `{kind}`.", remedy=nearest(kind, [*EXECUTORS]))
    if address is not None and kind != "ray":
        raise ConfigError(
            "`--address` is for Ray.", remedy="Add `--executor ray`, or leave it out."
        )
    if processes is not None and processes < 0:
        raise ConfigError(f"`--processes` is {processes}.", remedy="Give 0 or more.")
    if kind == "ray":
        from surmount.experiment.ray_cluster import RayExecutor  # noqa: PLC0415 - an extra

        return RayExecutor(listener, address=address, processes=processes)
    if kind == "in-process" or processes == 0:
        return InProcessExecutor(listener)
    return ProcessExecutor(cores() if processes is None else processes, listener)


def cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def run(
    root: Path,
    config: ExperimentConfig,
    executor: Executor,
    observer: RunObserver,
    *,
    on_ready: Callable[[GraphRunner], None] = lambda _: None,
    url: str | None = None,
    retries: int = RETRIES,
    stages: Iterable[Stage] | None = None,
) -> RunOutcome:
    """Run what is missing of an experiment, and keep an index of its artefacts.

    Parameters
    ----------
    root
        Folder claimed by :func:`begin`.
    config
        The experiment.
    executor, observer
        Where stages run, and who watches.
    on_ready
        Called with the runner before it starts, to let signals stop it.
    url
        An object store that has the same stages as the folder, for workers that do not see it.
    retries
        How often a stage is run again after its worker was lost.
    stages
        The graph; the protocol's if not given.
    """
    runner = GraphRunner(
        root,
        protocol(config) if stages is None else stages,
        executor,
        Journal(root, observer),
        depot=Depot(root=root, url=url),
        retries=retries,
    )
    on_ready(runner)
    with output_errors(root):
        return runner.run()


def _require_same(root: Path, config: ExperimentConfig) -> None:
    stored = completed(ExperimentConfig, read_record(root / RUN).get("config", {}))
    differing = differences(stored, to_record(config))
    if differing:
        key, (there, here) = next(iter(differing.items()))
        more = f" and {len(differing) - 1} more" if len(differing) > 1 else ""
        raise OutputError(
            f"{root} was made by another configuration: `{key}` is {there!r} there and {here!r} "
            f"here{more}.",
            remedy="Choose another --out folder, or pass --resume alone to go on with the "
            "configuration of that folder.",
        )
