"""``surmount config``: every key of a configuration with its value."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from surmount.cli.configuration_flags import ConfigurationOptions, run_configured
from surmount.core.configuration import dotted_keys, to_record
from surmount.core.printing import say
from surmount.experiment.config import ExperimentConfig


def config(arguments: Sequence[str]) -> int:
    """Print a configuration as TOML: save it, edit it, and give it back by --config."""
    return run_configured(
        ConfigurationOptions, _print, arguments, verb="config", description=str(config.__doc__)
    )


def _print(
    _options: ConfigurationOptions, chosen: ExperimentConfig, _beside: Mapping[str, Any]
) -> int:
    record = to_record(chosen)
    for key in dotted_keys(type(chosen)):
        value: Any = record
        for part in key.split("."):
            value = value[part]
        # TOML has no null; as text it is read as JSON again, like every text.
        say(f"{key} = {json.dumps('null' if value is None else value)}")
    return 0
