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
from collections.abc import Sequence

from surmount.core.errors import SurmountError
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


def _dispatch(arguments: Sequence[str] | None) -> int:
    import tyro  # noqa: PLC0415 - an extra: its absence is told in a sentence

    from surmount.cli.analyze import analyze  # noqa: PLC0415
    from surmount.cli.capability import capability  # noqa: PLC0415
    from surmount.cli.config import config  # noqa: PLC0415
    from surmount.cli.initiations import initiations  # noqa: PLC0415
    from surmount.cli.manoeuvres import manoeuvres  # noqa: PLC0415
    from surmount.cli.render import render  # noqa: PLC0415
    from surmount.cli.report import report  # noqa: PLC0415
    from surmount.cli.reproduce import reproduce  # noqa: PLC0415
    from surmount.cli.show import show  # noqa: PLC0415
    from surmount.cli.view import view  # noqa: PLC0415

    return tyro.extras.subcommand_cli_from_dict(
        {
            "reproduce": reproduce,
            "analyze": analyze,
            "report": report,
            "show": show,
            "render": render,
            "view": view,
            "capability": capability,
            "initiations": initiations,
            "manoeuvres": manoeuvres,
            "config": config,
        },
        prog="surmount",
        description="Determine a reinforcement-learning curriculum from the robot's own behaviour.",
        args=arguments,
    )


def _complain(error: SurmountError) -> int:
    print(f"surmount: {error.message}\n{error.remedy}", file=sys.stderr)
    return error.exit_code
