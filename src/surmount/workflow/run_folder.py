"""A run's output folder: which stages it should hold, which it holds, and what it was made with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from surmount.core.errors import InputError, IntegrityError, OutputError
from surmount.core.records import read_record
from surmount.workflow.earlier import up_to_date
from surmount.workflow.run_layout import (
    INDEX,
    MOST_NETWORKS,
    RESTARTS,
    RUN,
    TIMINGS,
    expected_stages,
    read_run_record,
)
from surmount.workflow.store import MANIFEST, Artefact, LocalStore, is_inside

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
        If ``run.json`` or ``index.json`` is not of this version or is damaged.
    IntegrityError
        If a stage's manifest does not belong to it.
    """
    if not (root / RUN).is_file():
        raise OutputError(
            f"There is no run in {root}: it has no {RUN}.",
            remedy="Give the --out folder of `surmount reproduce`.",
        )
    run = read_run_record(root / RUN)
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
        seconds=_seconds(root / TIMINGS),
        stages=stages,
        restarts={name: int(count) for name, count in _seconds(root / RESTARTS).items()},
        kinds=_kinds(stages),
        missing=tuple(name for name in expected_stages(checked["networks"]) if name not in stages),
    )


def _stages(root: Path) -> dict[str, Artefact]:
    folders = _indexed(root) if (root / INDEX).is_file() else _found(root)
    store = LocalStore(root)
    stages: dict[str, Artefact] = {}
    for name, folder in sorted(folders.items()):
        if not (folder / MANIFEST).is_file():
            continue  # deleted since, as the remedy for a damaged artefact says
        key = read_record(folder / MANIFEST).get("key")
        artefact = store.find(name, str(key))
        if artefact is None or artefact.folder.resolve() != folder.resolve():
            raise IntegrityError(
                f"{folder} does not hold stage `{name}`, as {root / INDEX} says.",
                remedy="Run the same command again: what is missing is repeated.",
            )
        stages[name] = artefact
    return stages


def _indexed(root: Path) -> dict[str, Path]:
    stages = read_run_record(root / INDEX).get("stages")
    if not isinstance(stages, dict) or not all(
        isinstance(folder, str) and is_inside(folder) for folder in stages.values()
    ):
        raise InputError(
            f"{root / INDEX} names no stages, or such outside the folder.",
            remedy="Run the same command again to write it.",
        )
    return {str(name): root / str(folder) for name, folder in cast(Record, stages).items()}


def _found(root: Path) -> dict[str, Path]:
    """Return the stages of a run that was killed before it could write its index.

    A stage with several results is left out: only the run knows which of them is current.
    """
    folders: dict[str, list[Path]] = {}
    base = root / "stages"
    for manifest in sorted(base.rglob(MANIFEST)):
        folder = manifest.parent
        if not folder.name.startswith("."):
            name = folder.parent.relative_to(base).as_posix()
            folders.setdefault(name, []).append(folder)
    return {name: found[0] for name, found in folders.items() if len(found) == 1}


def _kinds(stages: Mapping[str, Artefact]) -> tuple[Mapping[str, str], ...]:
    found: list[Mapping[str, str]] = []
    for artefact in stages.values():
        kind = _texts(read_record(artefact.folder / MANIFEST).get("made_with"))
        if kind and kind not in found:
            found.append(kind)
    return tuple(found)


def _texts(value: object) -> dict[str, str]:
    if not isinstance(value, dict):
        return {}
    return {str(key): str(text) for key, text in cast(Record, value).items()}


def _seconds(path: Path) -> dict[str, float]:
    if not path.is_file():
        return {}
    return {
        name: float(value)
        for name, value in read_record(path).items()
        if isinstance(value, int | float) and value >= 0
    }
