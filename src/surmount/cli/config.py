"""``surmount config``: every key of a configuration with its value."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.options import overrides
from surmount.core.configuration import dotted_keys, override, to_record
from surmount.experiment import ExperimentConfig
from surmount.experiment import preset as experiment_preset


def config(
    obstacle: Annotated[str, tyro.conf.Positional],
    *,
    preset: str = "smoke",
    config: Path | None = None,
    set: tuple[str, ...] = (),  # noqa: A002 - the option's name
) -> int:
    """Print a configuration as TOML: save it, edit it, and give it back by --config.

    Args:
        obstacle: narrow-channel, low-entrance or step.
        preset: smoke or paper.
        config: TOML or JSON file of configuration keys to change.
        set: Configuration keys to change, as key=value; they override the file.
    """
    chosen = override(experiment_preset(obstacle, preset), overrides(config, set))
    record = to_record(chosen)
    for key in dotted_keys(ExperimentConfig):
        value: object = record
        for part in key.split("."):
            value = value[part] if isinstance(value, dict) else value
        print(f"{key} = {json.dumps(value)}")
    return 0
