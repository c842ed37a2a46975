"""``surmount completion``: verbs and flags completed by the shell."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal

import tyro
from tyro.extras import subcommand_cli_from_dict

from surmount.cli import compare
from surmount.cli.configuration_flags import ConfigurationOptions, RunOptions, combined
from surmount.cli.main import VERBS, function_of
from surmount.experiment.presets import preset
from surmount.teachers.catalogue import TeachersConfig

TASK = "rstar/step"
"""Task whose flags are completed: a script must know them beforehand, and obstacles share them."""


def completion(shell: Annotated[Literal["bash", "zsh", "fish"], tyro.conf.Positional]) -> int:
    """Print a script that lets a shell complete verbs, flags and their choices.

    For Bash: source <(surmount completion bash), in ~/.bashrc for always. For zsh, write it to a
    file _surmount in a folder of $fpath; for fish, to ~/.config/fish/completions/surmount.fish.

    The flags of a configuration are those of the paper's obstacles.

    Args:
        shell: The shell.
    """
    subcommand_cli_from_dict(callables(), prog="surmount", args=["--tyro-print-completion", shell])
    return 0


def callables() -> dict[str, Callable[..., Any]]:
    """Return for each verb what its options are read into, flags of a configuration included."""
    config = preset(TASK, "smoke")
    configured = {
        "reproduce": combined(RunOptions, config, {}),
        "compare": combined(compare.Options, config, {compare.TEACHING: TeachersConfig()}),
        "config": combined(ConfigurationOptions, config, {}),
    }
    return {verb: configured.get(verb) or function_of(verb) for verb in VERBS}
