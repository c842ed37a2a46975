"""Stages and what they depend on: an experiment as a graph of pure functions.

A stage is a function of its configuration, its seed and the artefacts of other stages. Its key is
the hash of these, so a stage that was finished once is never run again, and one whose inputs have
changed always is. The key names the function by its kind, a word that outlives moves and renames.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from surmount.core.records import record_hash
from surmount.workflow.earlier import as_before
from surmount.workflow.monitor import Monitor
from surmount.workflow.store import Artefact

StageFunction = Callable[["StageContext"], None]


@dataclass(frozen=True, kw_only=True)
class StageContext:
    """What a stage function is given.

    Attributes
    ----------
    name
        Name of the stage.
    config
        Its configuration, as nested records.
    seed
        Its seed.
    inputs
        Finished stages it depends on, by role, each role in the order of the graph.
    output
        Empty folder to write its files to; published when the function returns.
    checkpoint
        Folder that survives an interruption and vanishes when the stage is finished.
    logs
        Folder for files that are not part of the result, such as TensorBoard's.
    monitor
        Takes progress and sentences, says when to stop.
    """

    name: str
    config: Mapping[str, Any]
    seed: int
    inputs: Mapping[str, tuple[Artefact, ...]]
    output: Path
    checkpoint: Path
    logs: Path
    monitor: Monitor


@dataclass(frozen=True, kw_only=True)
class Resources:
    """What a stage takes of a machine. They decide where it runs, and nothing about its result.

    Attributes
    ----------
    cpus
        Cores; every stage computes with one thread.
    memory_mb
        Most memory that it takes, in MB of 10⁶ bytes.
    """

    cpus: float = 1.0
    memory_mb: int = 1000


@dataclass(frozen=True, kw_only=True)
class StageKind:
    """What a stage does, under a name that never changes.

    Attributes
    ----------
    name
        Part of the key of every stage of this kind.
    function
        A function at the top level of a module, so that worker processes find it.
    version
        Raised whenever a change to the function changes what it produces.
    legacy
        ``"module:function"``, which keys held before there were kinds; empty for later kinds.
    """

    name: str
    function: StageFunction
    version: int = 1
    legacy: str = ""


@dataclass(frozen=True, kw_only=True)
class Stage:
    """One node of the graph.

    Attributes
    ----------
    name
        Unique name, also its folder: ``"initiation/network-0"``.
    kind
        What it does.
    config
        The part of the configuration it depends on, and no more, as
        :func:`~surmount.core.configuration.key_record` gives it.
    seed
        Its seed.
    inputs
        Names of the stages it takes, by role.
    resources
        What it takes of a machine; not part of its key.
    """

    name: str
    kind: StageKind
    config: Mapping[str, Any] = field(default_factory=dict[str, Any])
    seed: int = 0
    inputs: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])
    resources: Resources = field(default_factory=Resources)

    def key(self, finished: Mapping[str, Artefact]) -> str:
        """Return the hash of everything the stage depends on."""
        return self._hash({"kind": self.kind.name}, finished)

    def legacy_key(self, finished: Mapping[str, Artefact]) -> str | None:
        """Return the key that the stage had before there were kinds, if it is that old."""
        if not self.kind.legacy:
            return None
        return self._hash({"function": self.kind.legacy}, finished, config=as_before(self.config))

    def _hash(
        self,
        what: Mapping[str, str],
        finished: Mapping[str, Artefact],
        *,
        config: Mapping[str, Any] | None = None,
    ) -> str:
        return record_hash(
            {
                **what,
                "version": self.kind.version,
                "config": self.config if config is None else config,
                "seed": self.seed,
                "inputs": {
                    role: [finished[name].content_hash for name in names]
                    for role, names in self.inputs.items()
                },
            }
        )


def dependencies(stage: Stage) -> set[str]:
    """Return the names of all stages that a stage takes."""
    return {name for names in stage.inputs.values() for name in names}


def check_graph(stages: Iterable[Stage]) -> dict[str, Stage]:
    """Return the stages by name, in an order in which each comes after its inputs.

    Raises
    ------
    ValueError
        If a name is used twice, an input is missing, or there is a cycle: an error in the
        program, not in the user's input.
    """
    waiting = list(stages)
    names = [stage.name for stage in waiting]
    if len(set(names)) < len(names):
        raise ValueError(f"Two stages share a name among {names}.")
    ordered: dict[str, Stage] = {}
    while waiting:
        ready = [stage for stage in waiting if dependencies(stage) <= ordered.keys()]
        if not ready:
            raise ValueError(f"Stages wait for each other or for none: {[s.name for s in waiting]}")
        ordered |= {stage.name: stage for stage in ready}
        waiting = [stage for stage in waiting if stage.name not in ordered]
    return ordered
