"""``surmount config``: every key of a configuration with its value."""

from __future__ import annotations

import json
from typing import Annotated

import tyro

from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.core.configuration import dotted_keys, override, to_record
from surmount.experiment import ExperimentConfig
from surmount.experiment import preset as experiment_preset


def config(
    obstacle: Annotated[str, tyro.conf.Positional],
    *,
    preset: Annotated[str, tyro.conf.arg(metavar="{smoke,paper}")] = "smoke",
    config: ConfigFile = None,
    set: Assignments = (),  # noqa: A002 - the option's name
) -> int:
    """Print a configuration as TOML: save it, edit it, and give it back by --config.

    Args:
        obstacle: narrow-channel, low-entrance or step.
        preset: smoke or paper.
        config: TOML or JSON file of configuration keys to change.
        set: Configuration key to change, as key=value; may be repeated; overrides the file.
    """
    chosen = override(experiment_preset(obstacle, preset), overrides(config, set))
    record = to_record(chosen)
    for key in dotted_keys(ExperimentConfig):
        value: object = record
        for part in key.split("."):
            value = value[part] if isinstance(value, dict) else value
        # TOML has no null; as text it is read as JSON again, like every text.
        print(f"{key} = {json.dumps('null' if value is None else value)}")
    return 0
