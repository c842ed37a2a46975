"""Search for manoeuvres that overcome an obstacle, by the cross-entropy method.

A population of manoeuvres is drawn from independent Gaussians, tried in simulation, and the
Gaussians are fitted to the best (Rubinstein, "The cross-entropy method for combinatorial and
continuous optimization", 1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.errors import ConfigError
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.observations import Measures
from surmount.rstar.course.obstacles import Obstacle
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.course.start_poses import fixed_start
from surmount.rstar.manoeuvres.manoeuvre import Manoeuvre, Phase, Player
from surmount.rstar.robot import constants as c
from surmount.rstar.robot import kinematics

LOWER = np.array([0.05, -72.0, 0.0, -0.25, 0.2])
UPPER = np.array([0.25, 72.0, 100.0, 0.30, 4.0])
"""Range of a phase's fields: speed in m/s, FBEM and sprawl in degrees, position in m, time in s."""
STALL_M = 0.002
"""What counts as ground gained, in m."""


@dataclass(frozen=True, kw_only=True)
class SearchConfig:
    """How long and how widely to search."""

    phases: int = 3
    """Phases of a manoeuvre."""
    population: int = 192
    """Manoeuvres tried in each iteration."""
    elite: int = 16
    """Best manoeuvres that the next iteration is drawn around."""
    iterations: int = 10
    """Iterations at the most; the search ends with the first success."""
    horizon_s: float = 12.0
    """Time a manoeuvre is given, in s; the paper's trials take 20 s at the most."""
    stall_s: float = 3.0
    """A trial that gains no ground for so long has failed, in s. Creeping over an edge may take
    longer, but so does a search that waits for it."""

    def __post_init__(self) -> None:
        for name in ("phases", "population", "elite", "iterations"):
            if getattr(self, name) < 1:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy="Give at least one."
                )
        if self.elite > self.population:
            raise ConfigError(
                f"`elite` is {self.elite} of a population of {self.population}.",
                remedy="Choose fewer than are tried.",
            )
        for name in ("horizon_s", "stall_s"):
            if not getattr(self, name) > 0:
                raise ConfigError(
                    f"`{name}` is {getattr(self, name)}.", remedy="Give a time above zero."
                )


@dataclass(frozen=True, kw_only=True, eq=False)
class Trials:
    """What became of manoeuvres, each field of shape ``(trial,)``.

    Attributes
    ----------
    success
        Whether the base passed the target line.
    time_s
        Time until then, NaN without success.
    progress_m
        Largest sum of the wheels' position along the course and the front axle's height: how far
        and how high the robot came, which leaning the body forward does not raise.
    """

    success: BoolArray
    time_s: FloatArray
    progress_m: FloatArray


def try_out(
    simulation: Simulation,
    config: EnvConfig,
    sizes_mm: FloatArray,
    manoeuvres: Sequence[Manoeuvre],
    horizon_s: float,
    stall_s: float | None = None,
) -> Trials:
    """Play manoeuvres from the fixed start, each before an obstacle of its own size.

    Parameters
    ----------
    simulation
        As many simulations as manoeuvres, or more; its family's obstacle is placed anew.
    config
        What the simulation was made with.
    sizes_mm
        Size of the obstacle in mm, shape ``(manoeuvre,)``; any size that the blocks allow.
    manoeuvres
        One per trial.
    horizon_s
        Time given, in s.
    stall_s
        A trial that gains no ground for so long has failed, in s; None waits to the end.
    """
    stall_s = stall_s or horizon_s
    count = len(manoeuvres)
    start = fixed_start(config)
    for env in range(count):
        simulation.place(env, float(sizes_mm[env]), start)
    player = Player(manoeuvres, config.step_s)
    envs = simulation.batch.state.shape[0]
    running = np.arange(envs) < count
    success = np.zeros(envs, dtype=np.bool_)
    time_s = np.full(envs, np.nan)
    progress_m = np.full(envs, -np.inf)
    gained_s = np.zeros(envs)
    actions = np.zeros((envs, 3))
    elapsed_s, steps = 0.0, round(horizon_s / config.step_s)
    measures = simulation.measure()
    for step in range(steps):
        actions[:count] = player.act(measures.x_m[:count])
        running &= ~simulation.advance(actions, running)
        measures = simulation.measure()
        elapsed_s = (step + 1) * config.step_s
        now_m = _progress_m(measures)
        gained_s[now_m > progress_m + STALL_M] = elapsed_s
        progress_m = np.where(running, np.maximum(progress_m, now_m), progress_m)
        reached = running & (measures.x_m >= config.course.target_m)
        success |= reached
        time_s[reached] = elapsed_s
        fell = measures.z_m < -config.course.fall_depth_m
        running &= ~reached & ~fell & (elapsed_s - gained_s < stall_s)
        if not running.any():
            break
    return Trials(success=success[:count], time_s=time_s[:count], progress_m=progress_m[:count])


def _progress_m(measures: Measures) -> FloatArray:
    """Return position of mid-wheelbase plus height of the front axle, in m, shape ``(env,)``."""
    shift_m = kinematics.body_shift_mm(measures.fbem_deg) * 1e-3
    leg_m = kinematics.leg_length_mm(measures.fbem_deg) * 1e-3
    pitch, sprawl = np.deg2rad(measures.pitch_deg), np.deg2rad(measures.sprawl_deg)
    ahead_m, below_m = c.WHEELBASE_MM / 2 * 1e-3 - shift_m, leg_m * np.cos(sprawl)
    axle_m = measures.z_m + ahead_m * np.sin(pitch) - below_m * np.cos(pitch)
    return measures.x_m - shift_m * np.cos(pitch) + axle_m


@dataclass(frozen=True, kw_only=True, eq=False)
class SearchResult:
    """What a search found.

    Attributes
    ----------
    manoeuvre
        The fastest success of the iteration that brought the first ones, or None.
    successes
        All successes of that iteration, fastest first.
    tried
        Manoeuvres tried in all.
    progress_m
        Largest progress of any trial, in m; see :class:`Trials`.
    """

    manoeuvre: Manoeuvre | None
    successes: tuple[Manoeuvre, ...]
    tried: int
    progress_m: float


def search(
    obstacle: Obstacle,
    env: EnvConfig,
    size_mm: float,
    config: SearchConfig,
    *,
    seed: int,
    hints: Sequence[Manoeuvre] = (),
    simulation: Simulation | None = None,
) -> SearchResult:
    """Look for a manoeuvre that overcomes an obstacle of one size.

    Parameters
    ----------
    obstacle, env
        Family and physics.
    size_mm
        Width or height in mm; may lie beyond the paper's range.
    config
        Extent of the search.
    seed
        Seed of the draws.
    hints
        Manoeuvres to try first, for example those found for neighbouring sizes.
    simulation
        Simulations to use, at least ``config.population``; built if None.
    """
    rng = np.random.default_rng(seed)
    simulation = simulation or Simulation(obstacle, env, config.population, 1)
    width = config.phases * LOWER.size
    low, high = np.tile(LOWER, config.phases), np.tile(UPPER, config.phases)
    centre, spread = (low + high) / 2, (high - low) / 2
    population = rng.uniform(low, high, (config.population, width))
    given = [_vector(hint, config.phases) for hint in hints[: config.population]]
    if given:
        # A quarter around the hints, the hints themselves, and the rest from everywhere.
        near = min(config.population // 4, config.population - len(given))
        chosen = np.array(given)[rng.integers(len(given), size=near)]
        population[:near] = chosen + rng.normal(0.0, 0.1, (near, width)) * (high - low)
        population[near : near + len(given)] = given
    furthest, tried = -np.inf, 0
    for _ in range(config.iterations):
        population = np.clip(population, low, high)
        manoeuvres = [_manoeuvre(vector) for vector in population]
        sizes = np.full(len(manoeuvres), size_mm)
        trials = try_out(simulation, env, sizes, manoeuvres, config.horizon_s, config.stall_s)
        tried += len(manoeuvres)
        furthest = max(furthest, float(trials.progress_m.max()))
        score = np.where(trials.success, 10.0 - np.nan_to_num(trials.time_s), 0.0)
        order = np.argsort(-(score + trials.progress_m), kind="stable")
        if trials.success.any():
            found = tuple(manoeuvres[i] for i in order[: int(trials.success.sum())])
            return SearchResult(
                manoeuvre=found[0],
                successes=found,
                tried=tried,
                progress_m=furthest,
            )
        best = population[order[: config.elite]]
        centre, spread = best.mean(axis=0), best.std(axis=0)
        spread = np.maximum(spread, 0.03 * (high - low))
        population = rng.normal(centre, spread, (config.population, width))
        population[0] = best[0]
    return SearchResult(manoeuvre=None, successes=(), tried=tried, progress_m=furthest)


def _manoeuvre(vector: FloatArray) -> Manoeuvre:
    """Return the manoeuvre of a search vector: five numbers a phase."""
    rows = vector.reshape(-1, LOWER.size).round(4).tolist()
    return Manoeuvre(
        phases=tuple(
            Phase(
                speed_mps=speed, fbem_deg=fbem, sprawl_deg=sprawl, until_x_m=until, at_most_s=limit
            )
            for speed, fbem, sprawl, until, limit in rows
        )
    )


def _vector(manoeuvre: Manoeuvre, phases: int) -> FloatArray:
    """Return the search vector of a manoeuvre, its last phase repeated where it has fewer."""
    rows = [list(phase.values()) for phase in manoeuvre.to_record()][:phases]
    return np.array(rows + [rows[-1]] * (phases - len(rows))).ravel()
