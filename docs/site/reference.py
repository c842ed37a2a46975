"""The reference of the public face, from the docstrings: one page for each room of it.

What is public stands in ``src/surmount/__init__.pyi``; a name added there is in the reference.
"""

from __future__ import annotations

import re
from pathlib import Path

import pages
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files

STUB = Path(__file__).parents[2] / "src" / "surmount" / "__init__.pyi"
ROOMS = {
    "trials": ("Trials", "Logged trials, and how they are read and written."),
    "analysis": ("Analysis", "From trials to a curriculum, with the reasons."),
    "tasks": ("Tasks and curricula", "Task spaces, distributions over them, groups and levels."),
    "teachers": ("Teachers", "What chooses the tasks that are practised."),
    "envs": ("Environments", "The contract with environments, and the registry of tasks."),
    "learn": ("Learning", "The learner, its callback for loops of your own, and roll-outs."),
    "experiment": ("Experiments", "The whole protocol: one object, one configuration."),
    "report": ("Pages", "Pages of runs and analyses."),
    "exports": ("Exports", "Curricula for other frameworks."),
    "rstar": ("RSTAR", "The robot of the paper and its obstacles."),
    "core": (
        "Errors",
        "What is raised on purpose: a sentence of what is wrong, and one of what to do.",
    ),
}
"""Title of each room's page and what is on it, in the order of the reference."""
MOVED = {"core.axis": "tasks"}
"""Modules that are shown with another room."""


def public_names() -> dict[str, list[str]]:
    """Return the public names by the room whose page they are on."""
    found: dict[str, list[str]] = {room: [] for room in ROOMS}
    stub = STUB.read_text(encoding="utf-8")
    for module, name in re.findall(r"^from \.([\w.]+) import \w+ as (\w+)$", stub, re.MULTILINE):
        found[MOVED.get(module, module.partition(".")[0])].append(name)
    return {room: sorted(names, key=str.lower) for room, names in found.items() if names}


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """List the rooms' pages."""
    rooms = [f"reference/{room}.md" for room in public_names()]
    pages.expand(config.nav, "reference/", ["reference/README.md", *rooms])
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page for each room, and one that lists all names."""
    made = {}
    overview = ["# Python reference", "", "`import surmount` gives all of these."]
    for room, names in public_names().items():
        title, sentence = ROOMS[room]
        entries = [f"# {title}", sentence, *(f"::: surmount.{name}" for name in names)]
        made[f"reference/{room}.md"] = "\n\n".join(entries) + "\n"
        overview += ["", f"## [{title}]({room}.md)", "", sentence, ""]
        overview += [f"* [`{name}`][surmount.{name}]" for name in names]
    made["reference/README.md"] = "\n".join(overview) + "\n"
    return pages.add(files, config, made)
