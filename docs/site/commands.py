"""The reference of the command line, from the parsers that read it."""

from __future__ import annotations

import argparse
import html
import re
import warnings

import pages
import tyro
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files

from surmount.cli import main
from surmount.cli.completion import TASK, callables
from surmount.cli.configuration_flags import tables
from surmount.cli.main import CONFIGURED, GROUPS, function_of

ALL_FLAGS = f"""
With a task there is a flag for every key of its configuration. These are the ones of `{TASK}` and
the preset `smoke`; an environment of your own has its own settings below `env`.
"""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """List the verbs as the command itself does."""
    groups = [
        {group.capitalize(): [{verb: f"commands/{verb}.md"} for verb in verbs]}
        for group, verbs in GROUPS.items()
    ]
    pages.expand(config.nav, "commands/", ["commands/README.md", *groups])
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page for each verb, and one that lists them."""
    made = {f"commands/{verb}.md": page(verb) for verbs in GROUPS.values() for verb in verbs}
    overview = ["# Command line", "", "`surmount VERB --help` says the same in a terminal."]
    for group, verbs in GROUPS.items():
        overview += ["", f"## {group.capitalize()}", "", "| verb | |", "|---|---|"]
        overview += [f"| [`{verb}`]({verb}.md) | {what} |" for verb, what in verbs.items()]
    codes = re.findall(r"^(\d+) +(\w.*)$", str(main.__doc__), flags=re.MULTILINE)
    overview += ["", "## Exit codes", "", "| code | meaning |", "|---|---|"]
    overview += [f"| {code} | {meaning} |" for code, meaning in codes]
    made["commands/README.md"] = "\n".join(overview) + "\n"
    return pages.add(files, config, made)


def page(verb: str) -> str:
    """Return the page of one verb."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # pinned in constraints.txt
        parser = tyro.extras.get_parser(
            callables()[verb], prog=f"surmount {verb}", registry=tables()
        )
    described = (function_of(verb).__doc__ or "").partition("\n\n    Args:")[0]
    lines = [f"# surmount {verb}", "", *(line.strip() for line in described.splitlines())]
    if verb in CONFIGURED:
        lines += ALL_FLAGS.splitlines()
    for group in parser._action_groups:  # noqa: SLF001 - argparse has no other way to see them
        members = group._group_actions  # noqa: SLF001
        actions = [one for one in members if "--help" not in one.option_strings]
        if not actions:
            continue
        title = str(group.title).removesuffix(" options") or "options"
        lines += ["", f"## {_heading(title)}", "", _text(group.description or ""), ""]
        lines += ["| option | meaning |", "|---|---|"]
        lines += [_row(action) for action in actions]
    return "\n".join(lines) + "\n"


def _heading(title: str) -> str:
    return f"`{title}`" if "." in title else title.capitalize()


def _row(action: argparse.Action) -> str:
    value = "" if action.nargs == 0 else str(action.metavar or action.dest)
    value = value.replace("|", ",")
    names = " ".join(f"`{name}`" for name in action.option_strings)
    shown = f"{names} `{value}`" if names and value else names or f"`{value}`"
    return f"| {shown} | {_text(action.help or '')} |"


def _text(words: str) -> str:
    """Return a sentence as it may stand in a cell: what is in backticks stays code."""
    parts = re.split(r"(`[^`]*`)", " ".join(words.split()))
    return "".join(
        part.replace("|", r"\|")
        if part.startswith("`")
        else re.sub(r"([|*_\[\]])", r"\\\1", html.escape(part, quote=False))
        for part in parts
    )
