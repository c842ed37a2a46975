"""What a user asks to be shown, found and turned into motions.

A *source* is the name of an obstacle (its stored manoeuvre), a run's output folder, a network, a
table of trials, or a manoeuvre in a JSON file. Files that lie in a run's folder take obstacle and
configuration from the run.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

from surmount.core.arrays import FloatArray
from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError, InputError
from surmount.core.records import read_record
from surmount.experiment.origin import config_of, home
from surmount.learn.snapshot import Snapshot
from surmount.rstar.configured import obstacle_of
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.observations import Observations
from surmount.rstar.course.obstacles import OBSTACLES, Obstacle
from surmount.rstar.film.logged_trials import Log, logged_motion, run_log
from surmount.rstar.film.motion import Motion, Pilot, record_motion, stand_still
from surmount.rstar.film.policy_pilot import PolicyPilot
from surmount.rstar.manoeuvres.manoeuvre import Manoeuvre, Player
from surmount.rstar.manoeuvres.stored import stored_manoeuvre
from surmount.trials.table import read_trials
from surmount.workflow.run_folder import RunFolder, open_run
from surmount.workflow.run_layout import (
    ARMS,
    CURRICULUM,
    INITIATION,
    NETWORK_FILE,
    TRIALS_FILE,
    per_network,
)

STANDING_S = 2.0
"""How long a robot is shown that stands still, in s."""
NETWORK_SUFFIX, TABLE_SUFFIXES, MANOEUVRE_SUFFIX = ".safetensors", (".parquet", ".csv"), ".json"


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """What to show; an option that does nothing for its source is refused, not ignored."""

    source: str
    """Name of an obstacle, or path of a run's folder, a network, a table or a manoeuvre."""
    task: str | None = None
    """Obstacle of a file that lies in no run."""
    stage: str | None = None
    """Stage of a run's folder: one that trained, or one that logged trials."""
    sizes_mm: tuple[float, ...] = ()
    """Sizes of the obstacle in mm, one motion each; the hardest if none is given."""
    trials: tuple[int, ...] = ()
    """Numbers of logged trials, one motion each; 0 if none is given."""
    network: int | None = None
    """Network of a table of trials; its first if None."""
    seed: int | None = None
    """Seed of a policy's draws; 0 if None."""
    deterministic: bool = False
    """Let a policy act by its mean."""
    standing: bool = False
    """Let the robot stand at its start."""
    changes: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Overrides of the configuration, by dotted keys."""


def motions(wanted: Wanted) -> Iterator[Motion]:
    """Yield the motions that a user wants.

    Raises
    ------
    ConfigError
        If an option is missing, unknown, or does nothing for this source.
    InputError
        If a file or a size cannot be used, or a network does not fit.
    OutputError
        If a folder holds no run.
    IntegrityError
        If a run's file was changed after it was written.
    """
    path = Path(wanted.source)
    if wanted.source.removeprefix("rstar/") in OBSTACLES:
        return _by_script(wanted, None)
    if path.is_dir():
        return _of_run(wanted, open_run(path))
    if not path.is_file():
        near = nearest(wanted.source, [*OBSTACLES])
        raise InputError(
            f"`{wanted.source}` is neither an obstacle nor a file or folder.",
            remedy=f"Give {', '.join(OBSTACLES)}, or a path that exists. {near}",
        )
    if path.suffix == NETWORK_SUFFIX:
        _refuse(wanted, "a network's file", stage="--stage")
        return _by_network(wanted, path, *home(path))
    if path.suffix in TABLE_SUFFIXES:
        return _logged(wanted, path, *home(path))
    if path.suffix == MANOEUVRE_SUFFIX:
        return _by_script(wanted, path)
    raise InputError(
        f"{path} is no kind of file that can be shown.",
        remedy=f"Give a network ({NETWORK_SUFFIX}), a table of trials "
        f"({', '.join(TABLE_SUFFIXES)}), a manoeuvre ({MANOEUVRE_SUFFIX}) or a run's folder.",
    )


# Runs ------------------------------------------------------------------------------------------


def _of_run(wanted: Wanted, run: RunFolder) -> Iterator[Motion]:
    trained = [name for name in map(_first_network, (*ARMS, INITIATION)) if name in run.stages]
    stage = wanted.stage or next(iter(trained), "")
    if stage not in run.stages:
        finished = [name for name in run.stages if name.partition("/")[1]]
        raise InputError(
            f"The run in {run.root} has no finished stage `{stage}`."
            if wanted.stage
            else f"The run in {run.root} has trained no network yet.",
            remedy=f"Finished are: {', '.join(finished) or 'none'}.",
        )
    artefact = run.stages[stage]
    if NETWORK_FILE in artefact.files:
        return _by_network(wanted, artefact.path(NETWORK_FILE), run, stage)
    if TRIALS_FILE in artefact.files:
        return _logged(wanted, artefact.path(TRIALS_FILE), run, stage)
    raise InputError(
        f"Stage `{stage}` holds neither a network nor trials.",
        remedy=f"Name one that does, such as {_first_network(CURRICULUM)}.",
    )


def _first_network(kind: str) -> str:
    return per_network(kind, 0)


# Kinds of sources ------------------------------------------------------------------------------


def _by_script(wanted: Wanted, path: Path | None) -> Iterator[Motion]:
    _refuse(wanted, "a manoeuvre", stage="--stage", trials="--trial", network="--network")
    _refuse(wanted, "a manoeuvre", seed="--seed", deterministic="--deterministic")
    if path is None:
        _refuse(wanted, "the name of an obstacle", task="--task")
    else:
        _refuse(wanted, "a manoeuvre's file", standing="--stand")
    name = wanted.source if path is None else wanted.task
    obstacle, config = _course(wanted, task=name)
    for size_mm in wanted.sizes_mm or (obstacle.hardest,):
        if wanted.standing:
            yield record_motion(
                obstacle, config, size_mm, stand_still, caption="standing", longest_s=STANDING_S
            )
            continue
        if path is None:
            stored = stored_manoeuvre(obstacle.name, size_mm)
            manoeuvre, caption = stored.manoeuvre, f"stored manoeuvre for {stored.size_mm:g} mm"
        else:
            manoeuvre, caption = _read_manoeuvre(path), f"manoeuvre {path.name}"
        pilot = _script(Player([manoeuvre], config.step_s))
        yield record_motion(obstacle, config, size_mm, pilot, caption=caption)


def _script(player: Player) -> Pilot:
    def act(_: Observations, x_m: FloatArray) -> FloatArray:
        return player.act(x_m)

    return act


def _read_manoeuvre(path: Path) -> Manoeuvre:
    """Read a manoeuvre from a file: an object with `phases`."""
    phases = read_record(path).get("phases")
    if not isinstance(phases, list):
        raise InputError(
            f"{path} holds no manoeuvre.",
            remedy="Give an object with a list of `phases`, each with speed_mps, fbem_deg, "
            "sprawl_deg, until_x_m and at_most_s.",
        )
    return Manoeuvre.from_record(cast("list[dict[str, Any]]", phases))


def _by_network(wanted: Wanted, path: Path, run: RunFolder | None, stage: str) -> Iterator[Motion]:
    _refuse(wanted, "a network", trials="--trial", network="--network", standing="--stand")
    network = Snapshot.load(path)
    obstacle, config = _course(wanted, run=run, network=network, task=wanted.task)
    seed = wanted.seed or 0
    for size_mm in wanted.sizes_mm or (obstacle.hardest,):
        pilot = PolicyPilot(
            network, obstacle, config, seed=seed, deterministic=wanted.deterministic
        )
        drawn = "its mean actions" if wanted.deterministic else f"actions drawn by seed {seed}"
        yield record_motion(
            obstacle,
            config,
            size_mm,
            pilot,
            caption=f"{stage or path.name}, {drawn}",
            seed=seed,
        )


def _logged(wanted: Wanted, path: Path, run: RunFolder | None, stage: str) -> Iterator[Motion]:
    _refuse(wanted, "logged trials", seed="--seed", deterministic="--deterministic")
    _refuse(wanted, "logged trials", standing="--stand")
    table = read_trials(path)
    if run is not None and stage:
        _refuse(wanted, "trials of a run", changes="--set and --config")
        config_of(wanted.source, run=run, task=wanted.task)
        log = run_log(run, stage, table, str(path))
    else:
        obstacle, config = _course(wanted, run=run, task=wanted.task)
        if len(table.parameters) != 1:
            raise InputError(
                f"{path} has several task parameters: {', '.join(table.parameters)}.",
                remedy="RSTAR's obstacles have one, their size in mm.",
            )
        log = Log(source=path.name, trials=table, obstacle=obstacle, config=config)
    sizes = log.sizes_mm
    default = sizes[-1] if log.obstacle.harder > 0 else sizes[0]
    for size_mm in wanted.sizes_mm or (float(default),):
        for repetition in wanted.trials or (int(table.repetition.min()),):
            yield logged_motion(log, log.find(size_mm, repetition, wanted.network))


def _course(
    wanted: Wanted,
    *,
    run: RunFolder | None = None,
    network: Snapshot | None = None,
    task: str | None = None,
) -> tuple[Obstacle, EnvConfig]:
    """Return the obstacle and the settings that a source belongs to."""
    config = config_of(wanted.source, run=run, network=network, task=task, changes=wanted.changes)
    return obstacle_of(config), config.env


# Options ---------------------------------------------------------------------------------------


def _refuse(wanted: Wanted, what: str, **options: str) -> None:
    """Raise if one of the fields, by the option that sets it, was given."""
    unset = Wanted(source=wanted.source)
    for name, option in options.items():
        if getattr(wanted, name) != getattr(unset, name):
            raise ConfigError(f"With {what}, {option} would do nothing.", remedy="Leave it out.")
