"""Running an experiment in an output folder: begin it, or go on with the one that is there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from surmount.core.configuration import differences, to_record
from surmount.core.errors import OutputError
from surmount.core.records import read_record, write_record
from surmount.experiment.config import ExperimentConfig, config_from_record
from surmount.workflow.earlier import up_to_date
from surmount.workflow.provenance import provenance
from surmount.workflow.run_layout import RUN, SCHEMA
from surmount.workflow.store import output_errors


def load_config(root: Path) -> ExperimentConfig:
    """Return the configuration of the experiment in a folder.

    Raises
    ------
    OutputError
        If there is no experiment in the folder.
    """
    if not (root / RUN).is_file():
        raise OutputError(
            f"There is no experiment in {root}.",
            remedy="Give the --out folder of a run, or begin one without --resume.",
        )
    return config_from_record(up_to_date(read_record(root / RUN)["config"]))


def begin(root: Path, config: ExperimentConfig) -> None:
    """Claim a folder for an experiment, or recognise the same experiment in it.

    Raises
    ------
    OutputError
        If the folder holds an experiment with another configuration, or other files.
    """
    refuse_other(root, config)
    with output_errors(root):
        if not (root / RUN).exists():
            record = {
                "schema": SCHEMA,
                "config": to_record(config),
                **provenance(),
            }
            write_record(root / RUN, record)


def refuse_other(root: Path, config: ExperimentConfig) -> None:
    """Refuse a folder of something else, before anything is written to it.

    Raises
    ------
    OutputError
        If the folder holds an experiment with another configuration, or other files.
    """
    with output_errors(root):
        if (root / RUN).exists():
            _require_same(root, config)
        elif root.exists() and any(not path.name.startswith(".") for path in root.iterdir()):
            raise OutputError(
                f"{root} holds files that are not of an experiment.",
                remedy="Choose an --out folder that is empty or does not exist.",
            )


def _require_same(root: Path, config: ExperimentConfig) -> None:
    stored = load_config(root)
    if stored.fingerprint not in ("", config.fingerprint):  # runs of before may have none
        raise OutputError(
            f"What `{config.task}` is made from (its file, or its simulation's model) has changed "
            f"since the run in {root} began.",
            remedy="Choose another --out folder: results of two versions must not be mixed.",
        )
    known = replace(stored, fingerprint=config.fingerprint)
    differing = differences(to_record(known), to_record(config))
    if differing:
        key, (there, here) = next(iter(differing.items()))
        more = f" and {len(differing) - 1} more" if len(differing) > 1 else ""
        raise OutputError(
            f"{root} was made by another configuration: `{key}` is {there!r} there and {here!r} "
            f"here{more}.",
            remedy="Choose another --out folder, or pass --resume alone to go on with the "
            "configuration of that folder.",
        )
