"""What the stages of an experiment know of its environments."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from surmount.core.configuration import Record, from_record, key_record
from surmount.core.errors import ConfigError
from surmount.core.seeds import derive_seed
from surmount.envs.family import TaskFamily
from surmount.envs.registry import find_family
from surmount.experiment.config import ExperimentConfig


def task_part(config: ExperimentConfig) -> Record:
    """Return what the environments of an experiment depend on: family, settings, fingerprint."""
    return {
        "task": config.task,
        "env": key_record(config.env),
        "fingerprint": config.fingerprint or config.family.fingerprint(config.env),
    }


def family_and_settings(part: Mapping[str, Any]) -> tuple[TaskFamily, Any]:
    """Return the family of a stage and its settings.

    Raises
    ------
    ConfigError
        If the environments are made from something else than when the run began.
    """
    family = find_family(str(part["task"]))
    settings = from_record(family.settings, part["env"])
    if family.fingerprint(settings) != part["fingerprint"]:
        raise ConfigError(
            f"What `{family.name}` is made from (its file, or its simulation's model) has changed "
            "since this run began.",
            remedy="Choose another --out folder: results of two versions must not be mixed.",
        )
    return family, settings


def stage_seed(config: ExperimentConfig, *names: str | int) -> int:
    """Return the seed of a stage: it follows from the root seed, the task and the names."""
    return derive_seed(config.seed, config.task.rpartition("/")[2], *names)
