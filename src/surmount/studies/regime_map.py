"""Where a curriculum helps: both arms of the protocol over a grid of two settings.

Each cell of the grid is the whole protocol at reduced scale, with the same seeds in every cell.
What comes out is a regime: on the hard variants neither arm succeeds, only the curriculum does,
only the control does, or both do.
"""

from __future__ import annotations

import itertools
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.errors import ConfigError, InputError
from surmount.core.records import read_bytes
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.presets import configured, preset
from surmount.experiment.protocol import protocol
from surmount.experiment.stages import pooled_trials
from surmount.experiment.statistics import success_matrix
from surmount.stats.differences import network_difference
from surmount.tasks.curriculum import Curriculum
from surmount.workflow.graph import Stage
from surmount.workflow.run_layout import (
    ANALYSIS,
    ARMS,
    CURRICULUM_FILE,
    TRAININGS,
    TRIALS,
    per_network,
)
from surmount.workflow.store import Artefact

N_AXES = 2
_REMEDY = "Write a TOML file as docs/results/regime-map/step.toml is."


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One factor of the grid.

    Attributes
    ----------
    key
        Dotted configuration key.
    values
        What it is set to, in the order in which the map shows them.
    """

    key: str
    values: tuple[Any, ...]

    @property
    def name(self) -> str:
        """The last part of the key."""
        return self.key.rsplit(".", 1)[-1]


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One cell of the grid.

    Attributes
    ----------
    name
        Prefix of its stages.
    values
        Value of either axis.
    config
        The experiment.
    """

    name: str
    values: tuple[Any, Any]
    config: ExperimentConfig

    def stage(self, name: str) -> str:
        """Return the name that a stage of the protocol has in this cell."""
        return f"{self.name}/{name}"


@dataclass(frozen=True, kw_only=True)
class RegimeMap:
    """A grid and the rule by which its cells are judged.

    Attributes
    ----------
    obstacle
        Task family.
    axes
        Rows and columns of the grid.
    hard
        Lowest and highest value of the task parameter of the variants that are judged.
    solved
        Success rate on these from which an arm counts as successful.
    cells
        Row by row.
    """

    obstacle: str
    axes: tuple[Axis, Axis]
    hard: tuple[float, float]
    solved: float
    cells: tuple[Cell, ...]


def read_regime_map(path: Path) -> RegimeMap:
    """Read a TOML file that describes a map.

    It holds ``obstacle``, ``hard`` (two sizes), ``solved`` (a success rate), a table ``common`` of
    dotted keys to change in the paper's preset, and a table ``axes`` of two dotted keys, rows
    first, each with the list of its values.

    Raises
    ------
    InputError
        If the file is not of this form.
    ConfigError
        If a key is unknown or a value cannot be used.
    """
    try:
        record = tomllib.loads(read_bytes(path).decode("utf-8"))
        low, high = (float(size) for size in record["hard"])
        solved = float(record["solved"])
        axes = [Axis(key=key, values=tuple(values)) for key, values in record["axes"].items()]
        obstacle, common = str(record["obstacle"]), dict(record.get("common", {}))
    except (OSError, UnicodeDecodeError, ValueError, KeyError, AttributeError, TypeError) as error:
        raise InputError(
            f"{path} does not describe a regime map ({type(error).__name__}: {error}).",
            remedy=_REMEDY,
        ) from error
    if len(axes) != N_AXES or not all(axis.values for axis in axes):
        raise InputError(
            f"`axes` of {path} does not hold two keys with at least one value each.",
            remedy=_REMEDY,
        )
    if not (low <= high and 0 < solved <= 1):
        raise InputError(
            f"In {path}, `hard` does not ascend or `solved` is not above 0 and at most 1.",
            remedy=_REMEDY,
        )
    rows, columns = axes
    cells = tuple(
        _cell(obstacle, common, (rows, row), (columns, column))
        for row, column in itertools.product(rows.values, columns.values)
    )
    config = cells[0].config
    sizes = config.family.space(config.env).variants[:, 0]
    if not _hard((low, high), sizes).any():
        raise InputError(
            f"No variant lies within the hard ones, {low:g} to {high:g}.",
            remedy=f"Choose `hard` between {sizes.min():g} and {sizes.max():g}.",
        )
    return RegimeMap(
        obstacle=obstacle, axes=(rows, columns), hard=(low, high), solved=solved, cells=cells
    )


def _cell(
    obstacle: str, common: Mapping[str, Any], row: tuple[Axis, Any], column: tuple[Axis, Any]
) -> Cell:
    name = ",".join(f"{axis.name}={value}" for axis, value in (row, column))
    changes = {**common, row[0].key: row[1], column[0].key: column[1]}
    try:
        config = configured(preset(obstacle, "paper"), changes)
    except ConfigError as error:
        raise ConfigError(f"Cell {name}: {error.message}", remedy=error.remedy) from error
    return Cell(name=name, values=(row[1], column[1]), config=config)


def regime_stages(regimes: RegimeMap) -> list[Stage]:
    """Return the protocol of every cell as one graph.

    A stage has the same seed in every cell, so that cells are compared in pairs.
    """
    return [
        replace(
            stage,
            name=cell.stage(stage.name),
            inputs={role: tuple(map(cell.stage, names)) for role, names in stage.inputs.items()},
        )
        for cell in regimes.cells
        for stage in protocol(cell.config)
    ]


def summarise_regimes(
    regimes: RegimeMap, artefacts: Mapping[str, Artefact]
) -> list[dict[str, Any]]:
    """Return what came of every cell, row by row.

    Returns
    -------
    list of dict
        ``name`` and ``values`` of both axes; if the cell is finished, ``groups``, ``variants``,
        ``success`` (by initiation, curriculum and control, shape ``(network, variant)``), and what
        :func:`judge` says of them.
    """
    return [
        {"name": cell.name, "values": list(cell.values), **_outcome(regimes, cell, artefacts)}
        for cell in regimes.cells
    ]


def regime(curriculum: float, control: float, solved: float) -> str:
    """Name the regime of a cell by the success of both arms on the hard variants."""
    with_it, without = curriculum >= solved, control >= solved
    if with_it and without:
        return "both"
    if with_it:
        return "curriculum only"
    return "control only" if without else "neither"


def judge(
    success: Mapping[str, FloatArray], sizes: FloatArray, hard: tuple[float, float], solved: float
) -> dict[str, Any]:
    """Say who succeeds in a cell.

    Parameters
    ----------
    success
        Success rates after the initiation, with curriculum and without, ``(network, variant)``.
    sizes
        Task parameter of the variants, ``(variant,)``.
    hard
        Its lowest and highest value that is judged.
    solved
        Success rate from which an arm counts as successful.

    Returns
    -------
    dict
        ``hard`` and ``all``: for the hard and for all variants, the mean ``success`` of each
        training and the ``difference``, curriculum minus control over networks, with a paired t
        interval. ``regime`` by the hard variants, and ``regimes`` of the single variants.
    """
    parts = {"hard": _hard(hard, sizes), "all": np.full(sizes.shape, fill_value=True)}
    outcome: dict[str, Any] = {}
    for part, chosen in parts.items():
        arms = [success[arm][:, chosen] for arm in ARMS]
        outcome[part] = {
            "success": {kind: float(rates[:, chosen].mean()) for kind, rates in success.items()},
            "difference": network_difference(*arms, paired=True).to_record(),
        }
    with_it, without = (outcome["hard"]["success"][arm] for arm in ARMS)
    single = zip(*(success[arm].mean(axis=0).tolist() for arm in ARMS), strict=True)
    return outcome | {
        "regime": regime(with_it, without, solved),
        "regimes": [regime(one, other, solved) for one, other in single],
    }


def _outcome(regimes: RegimeMap, cell: Cell, artefacts: Mapping[str, Artefact]) -> dict[str, Any]:
    wanted = {
        kind: [
            cell.stage(per_network(TRIALS[kind], network))
            for network in range(cell.config.networks)
        ]
        for kind in TRAININGS
    }
    names = [name for stages in wanted.values() for name in stages]
    if not all(name in artefacts for name in [*names, cell.stage(ANALYSIS)]):
        return {}
    trials = {
        kind: pooled_trials(tuple(artefacts[name] for name in stages))
        for kind, stages in wanted.items()
    }
    sizes = trials[ARMS[0]].variants()[0][:, 0]
    success = {kind: success_matrix(table) for kind, table in trials.items()}
    curriculum = Curriculum.load(artefacts[cell.stage(ANALYSIS)].path(CURRICULUM_FILE))
    return {
        "variants": sizes.tolist(),
        "success": {kind: rates.tolist() for kind, rates in success.items()},
        "groups": [
            {"name": group.name, "variants": group.variants[:, 0].tolist()}
            for group in curriculum.groups
        ],
        **judge(success, sizes, regimes.hard, regimes.solved),
    }


def _hard(hard: tuple[float, float], sizes: FloatArray) -> BoolArray:
    low, high = hard
    return (sizes >= low) & (sizes <= high)
