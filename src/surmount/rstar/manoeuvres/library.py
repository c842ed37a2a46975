"""The stored manoeuvres: one for every variant, chosen for its margins, and how they were found."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import SurmountError
from surmount.core.printing import say
from surmount.core.seeds import derive_seed
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import Obstacle, find_obstacle
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.manoeuvres.manoeuvre import Manoeuvre
from surmount.rstar.manoeuvres.search import SearchConfig, search, try_out
from surmount.rstar.manoeuvres.stored import stored_manoeuvres
from surmount.rstar.manoeuvres.templates import templates

CANDIDATES = 16
"""Successful manoeuvres that are examined for each variant."""
STALL_S = 8.0
"""Time without any ground gained after which an examined manoeuvre has failed, in s."""
ATTEMPTS = 3
"""Searches for each variant at the most; a manoeuvre that bears everything ends them."""
FRICTION_MARGIN = 0.05
"""Relative change of friction, to either side, that a manoeuvre should bear."""
SIZE_MARGIN_MM = 0.5
"""How much harder an obstacle should still be overcome, in mm: half the finest spacing."""


@dataclass(frozen=True, kw_only=True)
class Condition:
    """Physics and size under which manoeuvres are examined.

    Attributes
    ----------
    name
        What differs from the default.
    physics_step_factor
        Factor on the physics step.
    friction_factor
        Factor on the friction of tyres and spokes.
    harder_mm
        How much harder the obstacle is.
    """

    name: str
    physics_step_factor: float = 1.0
    friction_factor: float = 1.0
    harder_mm: float = 0.0


CONDITIONS = (
    Condition(name="default"),
    Condition(name="half physics step", physics_step_factor=0.5),
    Condition(name="less friction", friction_factor=1 - FRICTION_MARGIN),
    Condition(name="more friction", friction_factor=1 + FRICTION_MARGIN),
    Condition(name="harder", harder_mm=SIZE_MARGIN_MM),
)
"""A stored manoeuvre succeeds under the first; one that succeeds under the second, too, goes before
all that do not; of the others it bears as many as possible."""
FIRST = 2
"""The first conditions, which go before the others."""


class Examiner:
    """Simulations of one obstacle under every condition.

    Parameters
    ----------
    obstacle, env
        Family and default physics.
    """

    def __init__(self, obstacle: Obstacle, env: EnvConfig) -> None:
        self._harder = obstacle.harder
        self._envs = [
            replace(
                env,
                robot=replace(
                    env.robot,
                    physics_step_s=env.robot.physics_step_s * condition.physics_step_factor,
                    friction=env.robot.friction * condition.friction_factor,
                ),
            )
            for condition in CONDITIONS
        ]
        self._simulations = [Simulation(obstacle, found, CANDIDATES, 1) for found in self._envs]

    def examine(
        self, manoeuvres: Sequence[Manoeuvre], size_mm: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return success and time of every manoeuvre under every condition.

        Parameters
        ----------
        manoeuvres
            At most :data:`CANDIDATES`.
        size_mm
            The variant.

        Returns
        -------
        tuple
            Success (0 or 1) and time in s (NaN without success), both of shape ``(condition,
            manoeuvre)``.
        """
        success, time_s = [], []
        for condition, env, simulation in zip(
            CONDITIONS, self._envs, self._simulations, strict=True
        ):
            size = np.full(len(manoeuvres), size_mm + self._harder * condition.harder_mm)
            trials = try_out(simulation, env, size, manoeuvres, env.episode_s, STALL_S)
            success.append(trials.success.astype(np.float64))
            time_s.append(trials.time_s)
        return np.array(success), np.array(time_s)


def build_library(
    obstacle_name: str,
    env: EnvConfig,
    *,
    seed: int,
    say: Callable[[str], None],
    searches: int = ATTEMPTS,
) -> list[dict[str, Any]]:
    """Find and choose a manoeuvre for every variant of an obstacle, from easy to hard.

    Of the package's own manoeuvres, those made by hand, those chosen for easier neighbours and
    those that searches find, the one is taken that succeeds at the default physics step and at half
    and bears most of the other conditions; of equals the fastest. What is at hand is tried first.

    Parameters
    ----------
    obstacle_name, env
        Family and physics.
    seed
        Root of the searches' seeds.
    say
        Told in a sentence what each variant brought.
    searches
        Searches for each variant at the most.

    Returns
    -------
    list of dict
        By variant: ``size_mm``, ``phases``, ``time_s`` and ``bears``, the names of the conditions
        under which it succeeds.

    Raises
    ------
    SurmountError
        If no manoeuvre is found for a variant.
    """
    obstacle = find_obstacle(obstacle_name)
    examiner = Examiner(obstacle, env)
    config = SearchConfig()
    simulation = Simulation(obstacle, env, config.population, 1)
    sizes = obstacle.variants[:: obstacle.harder]
    stored = stored_manoeuvres(obstacle_name)
    known: list[Manoeuvre] = []
    library: list[dict[str, Any]] = []
    for size in sizes.tolist():
        near = sorted(stored, key=lambda found: abs(found.size_mm - size))
        own = [found.manoeuvre for found in near]
        known = list(dict.fromkeys([*known[: CANDIDATES // 4], *own]))[:CANDIDATES]
        entry = _choose(known, examiner, size)
        if entry is None or len(entry["bears"]) < len(CONDITIONS):
            ready = _promising([*own, *templates()], examiner, size)
            known = list(dict.fromkeys([*ready, *known]))[:CANDIDATES]
            entry = _choose(known, examiner, size)
        for attempt in range(searches):
            if entry and len(entry["bears"]) == len(CONDITIONS):
                break
            result = search(
                obstacle,
                env,
                size,
                config,
                seed=derive_seed(seed, obstacle.name, f"{size:g}", attempt),
                hints=known,
                simulation=simulation,
            )
            if not result.successes:
                continue
            known = list(dict.fromkeys([*result.successes, *known]))[:CANDIDATES]
            found = _choose(known, examiner, size)
            if found and (entry is None or _worth_of(found) > _worth_of(entry)):
                entry = found
        if entry is None:
            raise SurmountError(
                f"No manoeuvre was found for {obstacle.name} {size:g} mm.",
                remedy="Raise friction or torque: this variant may not be feasible.",
            )
        known = list(dict.fromkeys([Manoeuvre.from_record(entry["phases"]), *known]))[:CANDIDATES]
        library.append(entry)
        say(f"{obstacle.name} {size:g} mm: {entry['time_s']:.2f} s, bears {entry['bears']}")
    return sorted(library, key=lambda found: found["size_mm"])


def _worth(success: FloatArray) -> FloatArray:
    """Return what manoeuvres are chosen by: the first conditions borne, then all.

    Parameters
    ----------
    success
        0 or 1, shape ``(condition, manoeuvre)``.
    """
    return success.sum(axis=0) + len(CONDITIONS) * success[:FIRST].sum(axis=0)


def _worth_of(entry: dict[str, Any]) -> float:
    borne = [[float(condition.name in entry["bears"])] for condition in CONDITIONS]
    return float(_worth(np.array(borne))[0])


def _promising(ready: Sequence[Manoeuvre], examiner: Examiner, size_mm: float) -> list[Manoeuvre]:
    """Return the manoeuvres that bear the first conditions, or else most, on a variant."""
    parts = [ready[begin : begin + CANDIDATES] for begin in range(0, len(ready), CANDIDATES)]
    success = np.concatenate([examiner.examine(part, size_mm)[0] for part in parts], axis=1)
    order = np.argsort(-_worth(success), kind="stable")[:CANDIDATES]
    return [ready[index] for index in order.tolist()]


def _choose(pool: Sequence[Manoeuvre], examiner: Examiner, size_mm: float) -> dict[str, Any] | None:
    """Return the entry of the best manoeuvre of a pool, or None if none will do."""
    success, time_s = examiner.examine(pool, size_mm)
    fit = success[0].astype(np.bool_)
    if not fit.any():
        return None
    score = np.where(fit, _worth(success) - 1e-3 * np.nan_to_num(time_s[0]), -1.0)
    best = int(score.argmax())
    return {
        "size_mm": size_mm,
        "time_s": round(float(time_s[0, best]), 6),
        "bears": [
            condition.name
            for condition, passed in zip(CONDITIONS, success[:, best], strict=True)
            if passed
        ],
        "phases": pool[best].to_record(),
    }


def _say(sentence: str) -> None:
    """Print at once: workers' output would otherwise wait for their end."""
    say(sentence, file=sys.stdout)


def build_libraries(
    obstacles: Sequence[str],
    env: EnvConfig,
    *,
    seed: int,
    processes: int,
    say: Callable[[str], None],
    searches: int = ATTEMPTS,
) -> dict[str, list[dict[str, Any]]]:
    """Return the libraries of several obstacles, each in a process of its own."""
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        futures = {
            name: pool.submit(build_library, name, env, seed=seed, say=_say, searches=searches)
            for name in obstacles
        }
        libraries = {name: future.result() for name, future in futures.items()}
    for name, library in libraries.items():
        say(f"{name}: {len(library)} manoeuvres")
    return libraries
