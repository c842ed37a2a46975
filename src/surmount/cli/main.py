"""Entry point of the command ``surmount``: verbs, errors in one sentence, exit codes.

====  =========================================================
code  meaning
====  =========================================================
0     done
1     something failed while running
2     wrong option, unknown preset, unknown configuration key
3     an input file cannot be used
4     the output folder, or standard output, cannot be used
5     a stored artefact does not fit its hash
6     an optional dependency is missing
7     learning failed
130   interrupted; the same command goes on
====  =========================================================

What needs no verb's module is answered here, without importing any: the list of verbs, the version,
and a mistyped verb.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module

from surmount import __version__
from surmount.cli import interrupting, streams
from surmount.cli.interrupting import INTERRUPTED
from surmount.core.errors import ConfigError, OutputError, SurmountError
from surmount.core.extras import told_error
from surmount.core.printing import complain, say

GROUPS: Mapping[str, Mapping[str, str]] = {
    "your trials": {
        "analyze": "determine a curriculum from logged trials of any robot",
        "convert": "logs of other frameworks into a table of trials",
        "export": "a curriculum or a network for another framework",
    },
    "your environment": {
        "tasks": "list the registered tasks with their parameters, ranges and units",
        "check": "whether an environment of your own keeps the contract",
        "rollout": "a table of trials of policies that were trained elsewhere",
        "config": "print every key of a configuration with its value",
    },
    "the paper, on its robot or on your environment": {
        "reproduce": "the whole protocol, from the first learning step to the report",
        "compare": "train by several teachers at equal budgets",
    },
    "look": {
        "show": "a curriculum, or the reasons for it, in words",
        "report": "draw the page of a run again, or one page over several",
        "evaluate": "try a trained network on every variant",
        "render": "a film or stills of a policy, a manoeuvre or logged trials",
        "view": "the same in MuJoCo's viewer",
    },
    "the laboratory's own studies": {
        "capability": "what the mechanism can do at all",
        "manoeuvres": "find a scripted manoeuvre for every variant",
        "initiations": "success after the initiation under many settings",
        "regimes": "where a curriculum helps, over a grid of two settings",
        "teachers": "which teacher helps on which kind of task, by a plan",
    },
    "this command": {
        "completion": "a script that lets a shell complete verbs and flags",
    },
}
"""Verbs by what they are for; each is a function in the module of its name."""
CONFIGURED = ("reproduce", "compare", "config")
"""Verbs whose configuration has flags: they read the command line themselves."""
VERBS = tuple(verb for group in GROUPS.values() for verb in group)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with its code."""
    interrupting.prepare()
    written_to = streams.prepare()
    code = run(arguments)
    try:
        streams.require_written(written_to)
    except BrokenPipeError:
        _leave_pipe()
    except OutputError as error:
        code = _complain(error)
    sys.exit(code)


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    try:
        return _dispatch(sys.argv[1:] if arguments is None else list(arguments))
    except KeyboardInterrupt:
        say("surmount: interrupted.", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        _leave_pipe()
        return 0
    except Exception as error:
        told = told_error(error)
        if told is None:
            raise
        return _complain(told)


def _dispatch(given: list[str]) -> int:
    verb = given[0] if given else "--help"
    if verb in VERBS:
        import tyro  # an extra: its absence is told in a sentence

        if verb in CONFIGURED:
            return function_of(verb)(given[1:])
        return tyro.cli(function_of(verb), prog=f"surmount {verb}", args=given[1:])
    if verb in ("--help", "-h", "help"):
        say(_help())
        return 0
    if verb == "--version":
        say(f"surmount {__version__}")
        return 0
    raise _unknown(verb)


def _help() -> str:
    width = max(map(len, VERBS))
    lines = [
        "usage: surmount VERB [OPTIONS]    (surmount VERB --help tells a verb's options)",
        "",
        "Determine a reinforcement-learning curriculum from the robot's own behaviour.",
    ]
    for group, verbs in GROUPS.items():
        lines += ["", group, *(f"  {verb:{width}}  {what}" for verb, what in verbs.items())]
    lines += ["", "--version tells the version."]
    return "\n".join(lines)


def _unknown(verb: str) -> ConfigError:
    from surmount.core.configuration import nearest  # only for this sentence

    return ConfigError(
        f"There is no verb `{verb}`.",
        remedy=f"{nearest(verb, [*VERBS])} `surmount --help` lists them all.",
    )


def function_of(verb: str) -> Callable[..., int]:
    """Return the function of a verb."""
    return getattr(import_module(f"surmount.cli.{verb}"), verb)


def _complain(error: SurmountError) -> int:
    complain(error.message, error.remedy)
    return error.exit_code


def _leave_pipe() -> None:
    """Write no more to a pipe whose reader has left."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
