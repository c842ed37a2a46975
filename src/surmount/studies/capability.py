"""What the mechanism can do at all: manoeuvres searched over size, friction, gear and torque.

The paper set its obstacles' sizes "according to the capabilities of the robot" (III-A). Friction
and gear are unknown, so they are chosen such that this holds: see
``docs/adr/0020-physics-by-capability.md``.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, field, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any, get_args

import numpy as np

from surmount.core.errors import ConfigError, InputError
from surmount.core.records import read_record, record_hash, write_record
from surmount.core.seeds import derive_seed
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import find_obstacle
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.manoeuvres.manoeuvre import Manoeuvre
from surmount.rstar.manoeuvres.search import SearchConfig, search, try_out
from surmount.rstar.manoeuvres.templates import templates
from surmount.rstar.robot.config import RobotConfig
from surmount.rstar.robot.kinematics import Gear

KIND = "capability map"
SCHEMA = 2
PHYSICS = ("gears", "frictions", "torque_factors")
"""Fields that say which columns a call adds; all else is common to the columns of a map."""
GIVE_UP_AFTER = 2
"""Sizes in a row without success after which harder ones are taken to be infeasible."""
TEMPLATE_STALL_S = 8.0
"""Time without any ground gained after which a hand-made manoeuvre has failed, in s."""
HINTS = 12
"""Manoeuvres that the search for the next size begins with."""


@dataclass(frozen=True, kw_only=True)
class CapabilityConfig:
    """Which physics and sizes to search."""

    obstacle: str = "step"
    """Name of the obstacle."""
    sizes_mm: tuple[float, ...] = (36, 42, 45, 47, 48, 49, 50, 51, 52, 54, 56, 58, 60, 65, 75)
    """Sizes from easy to hard, in mm; they may leave the paper's range. Small steps matter: a
    search begins with what overcame the size before, and finds more that way."""
    gears: tuple[str, ...] = ("wheels", "whegs", "both")
    """Running gears."""
    frictions: tuple[float, ...] = (0.7, 1.0, 1.3)
    """Coefficients of friction of tyres and spokes."""
    torque_factors: tuple[float, ...] = (1.0,)
    """Factors on the torque limits of all servos."""
    env: EnvConfig = field(default_factory=EnvConfig)
    """Everything else."""
    search: SearchConfig = field(default_factory=SearchConfig)
    """Extent of each search."""
    repetitions: int = 2
    """Searches with other seeds before a size counts as infeasible."""
    seed: int = 0
    """Root of the seeds."""

    def __post_init__(self) -> None:
        find_obstacle(self.obstacle)
        if not (self.sizes_mm and self.gears and self.frictions and self.torque_factors):
            raise ConfigError(
                "A capability map needs sizes, gears, frictions and torque factors.",
                remedy="Give at least one of each.",
            )
        unknown = set(self.gears) - set(get_args(Gear))
        if unknown:
            raise ConfigError(
                f"There is no gear `{min(unknown)}`.",
                remedy=f"Choose among {', '.join(get_args(Gear))}.",
            )
        if self.repetitions < 1:
            raise ConfigError(
                f"`repetitions` is {self.repetitions}.", remedy="Search at least once."
            )


@dataclass(frozen=True, kw_only=True)
class Column:
    """One physics of the map: all sizes are searched in order, each helped by the last."""

    gear: Gear
    friction: float
    torque_factor: float

    def robot(self, base: RobotConfig) -> RobotConfig:
        """Return the robot with this column's physics."""
        factor = self.torque_factor
        return replace(
            base,
            gear=self.gear,
            friction=self.friction,
            wheel_torque_nm=base.wheel_torque_nm * factor,
            sprawl_torque_nm=base.sprawl_torque_nm * factor,
            fbem_torque_nm=base.fbem_torque_nm * factor,
        )


def columns(config: CapabilityConfig) -> list[Column]:
    """Return the columns of a map."""
    return [
        Column(gear=gear, friction=friction, torque_factor=factor)  # type: ignore[arg-type]
        for gear, friction, factor in itertools.product(
            config.gears, config.frictions, config.torque_factors
        )
    ]


def explore(config: CapabilityConfig, column: Column) -> dict[str, Any]:
    """Search all sizes of one column and return its record.

    Manoeuvres made by hand are tried first: how many of the 72 succeed tells how much room a size
    leaves. Then others are searched. A size counts as infeasible when none succeeds; after two such
    sizes in a row the harder ones are not searched. Infeasible means "not found": the search gives
    a lower bound.
    """
    obstacle = find_obstacle(config.obstacle)
    env = replace(config.env, robot=column.robot(config.env.robot))
    ready = templates()
    simulation = Simulation(obstacle, env, max(config.search.population, len(ready)), 1)
    hints: tuple[Manoeuvre, ...] = ()
    cells: list[dict[str, Any]] = []
    missed = 0
    for size in config.sizes_mm:
        first = try_out(
            simulation, env, np.full(len(ready), size), ready, env.episode_s, TEMPLATE_STALL_S
        )
        passed = np.flatnonzero(first.success)
        tried, progress_m = len(ready), float(first.progress_m.max())
        found = ready[passed[first.time_s[passed].argmin()]] if passed.size else None
        for repetition in range(config.repetitions):
            if found is not None:
                break
            name = f"{column}/{size}/{repetition}"
            result = search(
                obstacle,
                env,
                size,
                config.search,
                seed=derive_seed(config.seed, name),
                hints=hints,
                simulation=simulation,
            )
            tried += result.tried
            progress_m = max(progress_m, result.progress_m)
            if result.manoeuvre is not None:
                found, hints = result.manoeuvre, result.successes[:HINTS]
                break
        cells.append(
            {
                "size_mm": size,
                "feasible": found is not None,
                "templates": int(passed.size),
                "tried": tried,
                "progress_m": progress_m,
                "manoeuvre": None if found is None else found.to_record(),
            }
        )
        missed = 0 if found is not None else missed + 1
        if missed == GIVE_UP_AFTER:
            break
    return {**asdict(column), "cells": cells}


def map_capability(
    config: CapabilityConfig,
    path: Path,
    *,
    provenance: Mapping[str, Any],
    processes: int,
    say: Callable[[str], None],
) -> dict[str, Any]:
    """Explore every column, keeping each in ``path`` as it ends; what is there is not repeated.

    Columns of further gears, frictions and torques join those of earlier calls.

    Parameters
    ----------
    config
        Physics and sizes.
    path
        JSON file of the map, written anew as each column ends.
    provenance
        Versions and machine, kept in every column.
    processes
        Worker processes of one thread.
    say
        Told in a sentence what each column brought.

    Raises
    ------
    InputError
        If ``path`` holds a map with other sizes, searches or settings.
    """
    settings = {name: value for name, value in asdict(config).items() if name not in PHYSICS}
    key = record_hash(settings)
    record: dict[str, Any] = {
        "kind": KIND,
        "schema": SCHEMA,
        "key": key,
        "config": settings,
        "columns": [],
    }
    if path.exists():
        record = read_record(path)
        if record.get("kind") != KIND or record.get("key") != key:
            raise InputError(
                f"{path} is not a capability map of this configuration.",
                remedy="Choose another file, or delete that one.",
            )
    done = [_name(found) for found in record["columns"]]
    todo = [column for column in columns(config) if _name(asdict(column)) not in done]
    # Workers are started anew, not forked: simulations hold threads.
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        futures = [pool.submit(explore, config, column) for column in todo]
        for future in as_completed(futures):
            record["columns"].append({**future.result(), "provenance": dict(provenance)})
            record["columns"].sort(key=_name)
            write_record(path, record)
            say(describe(future.result()))
    return record


def limit_mm(column: Mapping[str, Any]) -> float | None:
    """Return the hardest feasible size of a column, or None where none is feasible."""
    feasible = [float(cell["size_mm"]) for cell in column["cells"] if cell["feasible"]]
    return feasible[-1] if feasible else None


def describe(column: Mapping[str, Any]) -> str:
    """Return a column in a sentence."""
    limit = limit_mm(column)
    what = "no size is feasible" if limit is None else f"feasible up to {limit:g} mm"
    tried = sum(int(cell["tried"]) for cell in column["cells"])
    return f"{_label(column)}: {what} ({tried:,} manoeuvres tried)"


def _label(column: Mapping[str, Any]) -> str:
    torque = "" if column["torque_factor"] == 1 else f", torque x {column['torque_factor']:g}"
    return f"{column['gear']}, friction {column['friction']:g}{torque}"


def _name(column: Mapping[str, Any]) -> Sequence[Any]:
    return column["gear"], column["friction"], column["torque_factor"]
