"""Running an experiment in an output folder: begin it, or go on with the one that is there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from surmount.core.configuration import differences, to_record
from surmount.core.errors import InputError, OutputError
from surmount.core.records import sealed, write_record
from surmount.experiment.config import ExperimentConfig, config_from_record
from surmount.workflow.earlier import up_to_date
from surmount.workflow.graph import Stage
from surmount.workflow.provenance import provenance
from surmount.workflow.run_folder import open_run
from surmount.workflow.run_layout import RUN, SCHEMA, has_lost_its_record, read_run
from surmount.workflow.store import output_errors

GraphOf = Callable[[ExperimentConfig], list[Stage]]
"""Gives the stages of a configuration."""


def load_config(root: Path) -> ExperimentConfig:
    """Return the configuration of the experiment in a folder.

    Raises
    ------
    OutputError
        If there is no experiment in the folder.
    IntegrityError
        If its record was changed or damaged.
    """
    if not (root / RUN).is_file():
        raise OutputError(
            f"There is no experiment in {root}.",
            remedy="Give the --out folder of a run, or begin one without --resume.",
        )
    config = read_run(root).get("config")
    if not isinstance(config, dict):
        raise InputError(
            f"{root / RUN} holds no configuration of a run.",
            remedy="Give the --out folder of a run.",
        )
    return config_from_record(up_to_date(cast("dict[str, Any]", config)))


def begin(root: Path, config: ExperimentConfig, amended: GraphOf | None = None) -> None:
    """Claim a folder for an experiment, or recognise the same experiment in it.

    Parameters
    ----------
    root
        The folder.
    config
        The configuration.
    amended
        Gives the graph of a configuration: then the one in the folder may be changed, as far as no
        finished stage depends on what changes.

    Raises
    ------
    OutputError
        If the folder holds an experiment with another configuration, or other files.
    """
    changes = refuse_other(root, config, amended)
    with output_errors(root):
        if not (root / RUN).exists():
            record = {
                "schema": SCHEMA,
                "config": to_record(config),
                **provenance(),
            }
            write_record(root / RUN, sealed(record))
        elif changes:
            record = read_run(root)
            told = {key: list(values) for key, values in changes.items()}
            amended_before = cast("list[Any]", record.get("amended", []))
            record = record | {"config": to_record(config), "amended": [*amended_before, told]}
            write_record(root / RUN, sealed(record))


def refuse_other(
    root: Path, config: ExperimentConfig, amended: GraphOf | None = None
) -> dict[str, tuple[Any, Any]]:
    """Refuse a folder of something else, before anything is written to it.

    The arguments are those of :func:`begin`.

    Returns
    -------
    dict
        What changes in the configuration there, by dotted keys: values before and now.

    Raises
    ------
    OutputError
        If the folder holds an experiment with another configuration, or other files.
    """
    with output_errors(root):
        if (root / RUN).exists():
            return _changes(root, config, amended)
        if root.exists() and not (_is_empty(root) or has_lost_its_record(root)):
            raise OutputError(
                f"{root} holds files that are not of an experiment.",
                remedy="Choose an --out folder that is empty or does not exist.",
            )
    return {}


def _is_empty(root: Path) -> bool:
    return all(path.name.startswith(".") for path in root.iterdir())


def _changes(
    root: Path, config: ExperimentConfig, amended: GraphOf | None
) -> dict[str, tuple[Any, Any]]:
    stored = load_config(root)
    if stored.task != config.task:
        raise OutputError(
            f"{root} holds a run on {stored.task}, not on {config.task}.",
            remedy="Choose another --out folder.",
        )
    if stored.fingerprint not in ("", config.fingerprint):  # runs of before may have none
        raise OutputError(
            f"What `{config.task}` is made from (its file, or its simulation's model) has changed "
            f"since the run in {root} began.",
            remedy="Choose another --out folder: results of two versions must not be mixed.",
        )
    known = replace(stored, fingerprint=config.fingerprint)
    differing = differences(to_record(known), to_record(config))
    if not differing:
        return {}
    key, (there, here) = next(iter(differing.items()))
    more = f" and {len(differing) - 1} more" if len(differing) > 1 else ""
    if amended is None:
        raise OutputError(
            f"{root} was made by another configuration: `{key}` is {there!r} there and {here!r} "
            f"here{more}.",
            remedy="Choose another --out folder, or pass --resume alone to go on with the "
            "configuration of that folder; with --resume, what no finished stage depends on may "
            "be changed.",
        )
    before = {stage.name: stage for stage in amended(known)}
    now = {stage.name: stage for stage in amended(config)}
    done = [name for name in open_run(root).stages if name in now and name in before]
    changed = [name for name in done if now[name] != before[name]]
    if changed:
        raise OutputError(
            f"`{key}`, {there!r} in {root} and {here!r} here{more}, changes what has run already: "
            f"{changed[0]}" + (f" and {len(changed) - 1} more." if len(changed) > 1 else "."),
            remedy="Change only what belongs to stages that have not run, or choose another --out "
            "folder.",
        )
    return differing
