"""Where a file comes from: its run, and the configuration that it belongs to."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from surmount.core.configuration import to_record
from surmount.core.errors import ConfigError, InputError, SurmountError
from surmount.envs.registry import find_family
from surmount.experiment.config import ExperimentConfig, config_from_record
from surmount.experiment.presets import configured, preset
from surmount.learn.snapshot import TRAINED_ON, Snapshot
from surmount.workflow.earlier import up_to_date
from surmount.workflow.opening import opened
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
    opened(path)
    folder = path.resolve().parent
    for root in folder.parents:
        if (root / RUN).is_file():
            run = open_run(root)
            for name, artefact in run.stages.items():
                if artefact.folder.resolve() == folder and path.name in artefact.files:
                    return run, name
            return run, ""
    return None, ""


def config_of(
    source: str,
    *,
    run: RunFolder | None = None,
    network: Snapshot | None = None,
    task: str | None = None,
    changes: Mapping[str, Any] = NO_CHANGES,
) -> ExperimentConfig:
    """Return the configuration that a file belongs to.

    A run's file takes it from the run, a network from what it was trained on (it may be tried on
    another task of the same settings); everything else takes the task that the user names and the
    defaults.

    Parameters
    ----------
    source
        How errors name the file.
    run, network
        The run that it lies in; the network that it is.
    task
        Family of tasks that the user names.
    changes
        The user's overrides, by dotted keys of :class:`ExperimentConfig`.

    Raises
    ------
    ConfigError
        If no task is known, or the one named is not the run's.
    InputError
        If a network tells nothing usable of what it was trained on.
    """
    named = None if task is None else find_family(task).name
    base = _known(source, run, network)
    if base is not None and named not in (None, base.task):
        if run is not None:
            raise ConfigError(
                f"{source} belongs to a run on {base.task}, not on {named}.",
                remedy="Leave the task out.",
            )
        base = config_from_record(to_record(base) | {"task": named, "fingerprint": ""})
    if base is None:
        named = named or changes.get("task")
        if named is None:
            raise ConfigError(
                f"{source} lies in no run and does not say which task it belongs to.",
                remedy="Give --task, such as one of those that `surmount tasks` lists.",
            )
        base = preset(named, "paper")
    chosen = configured(base, changes)
    if chosen.task != base.task:
        raise ConfigError(
            f"The configuration is for {chosen.task}, not for {base.task}.",
            remedy="Give the configuration of this task, or leave the task out.",
        )
    return chosen


def _known(source: str, run: RunFolder | None, network: Snapshot | None) -> ExperimentConfig | None:
    if run is not None:
        return config_from_record(run.config)
    trained_on = None if network is None else network.record.get(TRAINED_ON)
    if trained_on is None:
        return None
    try:
        trained_on = up_to_date(trained_on)
        return config_from_record(
            {"preset": "paper", "task": trained_on["task"], "env": trained_on["env"]}
        )
    except (SurmountError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{source} does not say in this version's terms what it was trained on ({error}).",
            remedy="Use the version of Surmount that wrote it.",
        ) from error
