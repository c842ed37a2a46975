"""``surmount manoeuvres``: find and choose a scripted manoeuvre for every variant."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.core.printing import say
from surmount.rstar.course.obstacles import OBSTACLES


def manoeuvres(
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="FILE.json")],
    obstacles: tuple[str, ...] = tuple(OBSTACLES),
    config: ConfigFile = None,
    set: Assignments = (),  # noqa: A002 - the option's name
    seed: int = 0,
    searches: Annotated[int | None, tyro.conf.arg(metavar="N")] = None,
    processes: int = 2,
) -> int:
    """Find a manoeuvre for every variant, chosen for the margins that it bears.

    The package's own manoeuvres were made by this command; with another robot's configuration it
    shows which variants are feasible for that one.

    Args:
        out: File for the manoeuvres.
        obstacles: Obstacles to search.
        config: TOML or JSON file of options to change, such as robot.friction = 1.0.
        set: Option to change, as key=value; may be repeated; overrides the file.
        seed: Root of the searches' seeds.
        searches: Searches for each variant at the most, 3 if left out; 0 tries only the package's
            own manoeuvres and those made by hand.
        processes: Worker processes of one thread each, one per obstacle.
    """
    say(f"Searching {', '.join(obstacles)}; the first size takes a while", file=sys.stderr)
    from surmount.core.configuration import override, to_record
    from surmount.core.records import write_record
    from surmount.rstar.course.config import EnvConfig
    from surmount.rstar.manoeuvres.library import build_libraries
    from surmount.workflow.provenance import provenance
    from surmount.workflow.store import output_errors

    env = override(EnvConfig(), overrides(config, set))
    with output_errors(out.parent):
        libraries = build_libraries(
            obstacles,
            env,
            seed=seed,
            processes=processes,
            say=print,
            **({} if searches is None else {"searches": searches}),
        )
        write_record(
            out,
            {
                "kind": "manoeuvres",
                "schema": 1,
                "env": to_record(env),
                "seed": seed,
                **provenance(),
                "obstacles": libraries,
            },
        )
    return 0
