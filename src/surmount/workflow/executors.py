"""Executors by name."""

from __future__ import annotations

import os

from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError
from surmount.workflow.executor import Executor, Listener
from surmount.workflow.in_process import InProcessExecutor
from surmount.workflow.local_processes import ProcessExecutor

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
        from surmount.workflow.ray_cluster import RayExecutor  # noqa: PLC0415 - an extra

        return RayExecutor(listener, address=address, processes=processes)
    if kind == "in-process" or processes == 0:
        return InProcessExecutor(listener)
    return ProcessExecutor(cores() if processes is None else processes, listener)


def cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
