"""Options that say where a run's stages are worked on, the same for every verb that runs some."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, Any

import tyro

from surmount.core.errors import ConfigError
from surmount.workflow.executor import RETRIES, Executor, Listener


@dataclass(frozen=True, kw_only=True)
class Workers:
    """Options that choose an executor."""

    executor: Annotated[str, tyro.conf.arg(metavar="{in-process,processes,ray}")] = "processes"
    """Where stages run: in this process, in local worker processes, or on Ray."""
    processes: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Worker processes of one thread each; one per core if left out; 0 runs all in this one."""
    address: Annotated[str | None, tyro.conf.arg(metavar="HOST:PORT")] = None
    """Head of a running Ray cluster; without it, Ray is started on this machine."""
    store: Annotated[str | None, tyro.conf.arg(metavar="URL")] = None
    """Object store (any fsspec URL) that keeps the same stages as --out: for workers that do not
    see that folder, and to go on elsewhere."""
    retries: Annotated[int, tyro.conf.arg(metavar="N")] = RETRIES
    """How often a stage is run again, from its checkpoint, after its worker was killed."""

    def checked(self) -> dict[str, Any]:
        """Return the options as arguments, after refusing what cannot be."""
        if self.retries < 0:
            raise ConfigError(f"`--retries` is {self.retries}.", remedy="Give 0 or more.")
        return dataclasses.asdict(self)

    def make(self, listener: Listener) -> Executor:
        """Return the executor."""
        from surmount.workflow.executors import make_executor

        return make_executor(self.processes, listener, kind=self.executor, address=self.address)


WorkerOptions = tyro.conf.OmitArgPrefixes[Workers]
