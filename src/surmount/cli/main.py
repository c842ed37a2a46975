"""Entry point of the command ``surmount``: verbs, errors in one sentence, exit codes.

====  =========================================================
code  meaning
====  =========================================================
0     done
1     something failed while running
2     wrong option, unknown preset, unknown configuration key
3     an input file cannot be used
4     the output folder cannot be used
5     a stored artefact does not fit its hash
6     an optional dependency is missing
7     learning failed
130   interrupted; the same command goes on
====  =========================================================
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from importlib import import_module

from surmount.core.errors import ConfigError, SurmountError
from surmount.core.extras import missing_extra

INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with its code."""
    sys.exit(run(arguments))


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    try:
        return _dispatch(arguments)
    except SurmountError as error:
        return _complain(error)
    except ModuleNotFoundError as error:
        known = missing_extra(error)
        if known is None:
            raise
        return _complain(known)
    except KeyboardInterrupt:
        print("surmount: interrupted.", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the reader has left
        return 0


VERBS = (
    "reproduce",
    "check",
    "compare",
    "analyze",
    "convert",
    "export",
    "report",
    "show",
    "evaluate",
    "render",
    "view",
    "capability",
    "initiations",
    "regimes",
    "manoeuvres",
    "config",
)
"""Each is a function in the module of its name."""


def _dispatch(arguments: Sequence[str] | None) -> int:
    import tyro  # noqa: PLC0415 - an extra: its absence is told in a sentence

    given = sys.argv[1:] if arguments is None else list(arguments)
    if given and given[0] in VERBS:  # needs the extras of this verb, and of no other
        verb = given[0]
        return tyro.cli(_function(verb), prog=f"surmount {verb}", args=given[1:])
    return tyro.extras.subcommand_cli_from_dict(
        {verb: _function(verb) for verb in VERBS if _is_installed(verb)},
        prog="surmount",
        description="Determine a reinforcement-learning curriculum from the robot's own behaviour.",
        args=given,
    )


def _function(verb: str) -> Callable[..., int]:
    try:
        module = import_module(f"surmount.cli.{verb}")
    except Exception as error:
        asked = os.environ.get("MUJOCO_GL")  # MuJoCo tries it when it is imported, for any verb
        if not asked or isinstance(error, ModuleNotFoundError | SurmountError):
            raise
        raise ConfigError(
            f"MuJoCo cannot draw as MUJOCO_GL={asked} asks ({error}).",
            remedy="Unset MUJOCO_GL: a way to draw is found without it.",
        ) from error
    return getattr(module, verb)


def _is_installed(verb: str) -> bool:
    try:
        _function(verb)
    except ModuleNotFoundError as error:
        if missing_extra(error) is None:
            raise
        return False
    return True


def _complain(error: SurmountError) -> int:
    print(f"surmount: {error.message}\n{error.remedy}", file=sys.stderr)
    return error.exit_code
