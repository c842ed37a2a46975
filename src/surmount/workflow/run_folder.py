"""A run's output folder: which stages it should hold, which it holds, and what it was made with."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from surmount.core.errors import InputError, OutputError
from surmount.core.records import read_sealed
from surmount.workflow.earlier import up_to_date
from surmount.workflow.run_layout import (
    MOST_NETWORKS,
    RESTARTS,
    RUN,
    TIMINGS,
    expected_stages,
    read_index,
    read_numbers,
    read_run,
)
from surmount.workflow.store import MANIFEST, MANIFEST_KEYS, Artefact, LocalStore, is_inside

Record = dict[str, Any]


@dataclass(frozen=True, kw_only=True, eq=False)
class RunFolder:
    """What an output folder holds.

    Attributes
    ----------
    root
        The folder.
    config
        The configuration as nested records.
    versions, machine
        What the run was made with.
    seconds
        Time that each stage took, where known.
    stages
        Finished stages by name.
    missing
        Names of stages that the configuration asks for and that are not finished.
    restarts
        How often stages lost their worker and were run again, where they were.
    kinds
        What the stages were made with, each combination of versions and machine once.
    """

    root: Path
    config: Record
    versions: Mapping[str, str]
    machine: Mapping[str, str]
    seconds: Mapping[str, float]
    stages: Mapping[str, Artefact]
    missing: tuple[str, ...]
    restarts: Mapping[str, int]
    kinds: tuple[Mapping[str, str], ...]

    @property
    def networks(self) -> int:
        """Number of networks that the configuration asks for."""
        return int(self.config["networks"])

    @property
    def task(self) -> str:
        """Name of the family of tasks."""
        return str(self.config["task"])

    @property
    def preset(self) -> str:
        """Name of the preset the configuration began as."""
        return str(self.config["preset"])

    @property
    def protocol(self) -> dict[str, Artefact]:
        """The finished stages of the protocol: none of a comparison with other teachers."""
        expected = set(expected_stages(self.networks))
        return {name: found for name, found in self.stages.items() if name in expected}

    @property
    def protocol_s(self) -> float:
        """Time that the stages of the protocol took together, where known, in s."""
        return sum(self.seconds.get(name, 0.0) for name in self.protocol)

    @property
    def finished(self) -> bool:
        """Whether nothing is missing."""
        return not self.missing

    def numbered(self, kind: str) -> dict[int, Artefact]:
        """Return the finished stages of a kind by the network they belong to, ascending."""
        found = {
            int(name.rpartition("-")[2]): artefact
            for name, artefact in self.stages.items()
            if name.startswith(f"{kind}/network-") and name.rpartition("-")[2].isdecimal()
        }
        return dict(sorted(found.items()))


def open_run(root: Path) -> RunFolder:
    """Read what an output folder holds, without reading the artefacts themselves.

    Raises
    ------
    OutputError
        If there is no run in the folder.
    InputError
        If ``run.json`` is not of this version.
    IntegrityError
        If ``run.json`` or a stage's manifest was changed or damaged.
    """
    if not (root / RUN).is_file():
        raise OutputError(
            f"There is no run in {root}: it has no {RUN}.",
            remedy="Give the --out folder of `surmount reproduce`.",
        )
    run = read_run(root)
    config = run.get("config")
    if isinstance(config, dict):
        config = up_to_date(cast(Record, config))
    if not isinstance(config, dict) or not {"task", "preset", "networks"} <= config.keys():
        raise InputError(
            f"{root / RUN} holds no configuration of a run.",
            remedy="Give the --out folder of `surmount reproduce`.",
        )
    checked = cast(Record, config)
    if not isinstance(checked["networks"], int) or not 1 <= checked["networks"] <= MOST_NETWORKS:
        raise InputError(
            f"{root / RUN} names {str(checked['networks'])[:40]} networks.",
            remedy="Give the --out folder of `surmount reproduce`.",
        )
    stages = _stages(root)
    return RunFolder(
        root=root,
        config=checked,
        versions=_texts(run.get("versions")),
        machine=_texts(run.get("machine")),
        seconds=read_numbers(root / TIMINGS),
        stages=stages,
        restarts={name: int(count) for name, count in read_numbers(root / RESTARTS).items()},
        kinds=_kinds(stages),
        missing=tuple(name for name in expected_stages(checked["networks"]) if name not in stages),
    )


def _stages(root: Path) -> dict[str, Artefact]:
    """Return the finished stages: those of the index, or where it is damaged, all there are."""
    indexed = read_index(root)
    if indexed is not None:
        stages = _held(root, indexed)
        if stages is not None:
            return stages
    return _held(root, _found(root)) or {}


def _held(root: Path, folders: Mapping[str, str]) -> dict[str, Artefact] | None:
    """Return the stages in these folders; ``None`` where one is not what it is said to be."""
    store = LocalStore(root)
    stages: dict[str, Artefact] = {}
    for name, relative in sorted(folders.items()):
        folder = root / relative
        if not is_inside(relative) or relative.rpartition("/")[0] != f"stages/{name}":
            return None
        if not os.path.isdir(folder):  # noqa: PTH112 - also false for a name that no system takes
            continue  # deleted since, as the remedy for a damaged artefact says
        artefact = store.find(name, _key(folder))
        if artefact is None or artefact.folder.resolve() != folder.resolve():
            return None
        stages[name] = artefact
    return stages


def _key(folder: Path) -> str:
    remedy = f"Delete {folder} and run again: only this stage is repeated."
    return str(read_sealed(folder / MANIFEST, MANIFEST_KEYS, remedy=remedy).get("key"))


def _found(root: Path) -> dict[str, str]:
    """Return the folders of a run that was killed before it could write its index.

    A stage with several results is left out: only the run knows which of them is current.
    """
    folders: dict[str, list[str]] = {}
    base = root / "stages"
    for manifest in sorted(base.rglob(MANIFEST)):
        folder = manifest.parent
        if not folder.name.startswith("."):
            name = folder.parent.relative_to(base).as_posix()
            folders.setdefault(name, []).append(folder.relative_to(root).as_posix())
    return {name: found[0] for name, found in folders.items() if len(found) == 1}


def _kinds(stages: Mapping[str, Artefact]) -> tuple[Mapping[str, str], ...]:
    found: list[Mapping[str, str]] = []
    for artefact in stages.values():
        kind = _texts(artefact.made_with)
        if kind and kind not in found:
            found.append(kind)
    return tuple(found)


def _texts(value: object) -> dict[str, str]:
    if not isinstance(value, dict):
        return {}
    return {str(key): str(text) for key, text in cast(Record, value).items()}
