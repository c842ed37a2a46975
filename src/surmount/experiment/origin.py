"""Where a file comes from: its run, and the obstacle and configuration that it belongs to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from surmount.core.configuration import from_record, override
from surmount.core.errors import ConfigError, InputError
from surmount.experiment.config import ExperimentConfig
from surmount.experiment.presets import preset
from surmount.learn import TRAINED_ON, Snapshot
from surmount.rstar.course import OBSTACLES, EnvConfig, Obstacle, find_obstacle
from surmount.workflow.run_folder import RunFolder, open_run
from surmount.workflow.run_layout import RUN

NO_CHANGES: Mapping[str, Any] = MappingProxyType({})


def home(path: Path) -> tuple[RunFolder | None, str]:
    """Return the run that a file lies in, and the stage it belongs to; empty where there is none.

    Raises
    ------
    IntegrityError
        If the file was changed after the run wrote it.
    """
    folder = path.resolve().parent
    for root in folder.parents:
        if (root / RUN).is_file():
            run = open_run(root)
            for name, artefact in run.stages.items():
                if artefact.folder.resolve() == folder and path.name in artefact.files:
                    artefact.path(path.name)  # checked against its hash
                    return run, name
            return run, ""
    return None, ""


def course(
    source: str,
    *,
    run: RunFolder | None = None,
    network: Snapshot | None = None,
    name: str | None = None,
    changes: Mapping[str, Any] = NO_CHANGES,
) -> tuple[Obstacle, EnvConfig]:
    """Return the obstacle and the configuration that a file belongs to.

    A run's file takes both from the run, a network from what it was trained on (it may be tried on
    another obstacle); everything else takes the obstacle that the user names and the defaults.

    Parameters
    ----------
    source
        How errors name the file.
    run, network
        The run that it lies in; the network that it is.
    name
        Obstacle that the user names.
    changes
        The user's overrides, by dotted keys of :class:`ExperimentConfig`.

    Raises
    ------
    ConfigError
        If no obstacle is known, or the one named is not the run's.
    InputError
        If a network tells nothing usable of what it was trained on.
    """
    base = _known(source, run, network)
    if base is not None and name not in (None, base.obstacle):
        if run is not None:
            raise ConfigError(
                f"{source} belongs to a run on {base.obstacle}, not on {name}.",
                remedy="Leave the obstacle out.",
            )
        base = replace(base, obstacle=name)
    if base is None:
        name = name or changes.get("obstacle")
        if name is None:
            raise ConfigError(
                f"{source} lies in no run and does not say which obstacle it belongs to.",
                remedy=f"Give --obstacle {', '.join(OBSTACLES)}.",
            )
        base = preset(name, "paper")
    chosen = override(base, changes)
    if chosen.obstacle != base.obstacle:
        raise ConfigError(
            f"The configuration is for {chosen.obstacle}, not for {base.obstacle}.",
            remedy="Give the configuration of this obstacle, or leave the obstacle out.",
        )
    return find_obstacle(chosen.obstacle), chosen.env


def _known(source: str, run: RunFolder | None, network: Snapshot | None) -> ExperimentConfig | None:
    if run is not None:
        return from_record(ExperimentConfig, run.config)
    trained_on = None if network is None else network.record.get(TRAINED_ON)
    if trained_on is None:
        return None
    try:
        record = {"scale": "paper", "obstacle": trained_on["obstacle"], "env": trained_on["env"]}
        known = from_record(ExperimentConfig, record)
        find_obstacle(known.obstacle)
    except (ConfigError, KeyError, TypeError) as error:
        raise InputError(
            f"{source} does not say in this version's terms what it was trained on ({error}).",
            remedy="Use the version of Surmount that wrote it.",
        ) from error
    return known
