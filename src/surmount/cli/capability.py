"""``surmount capability``: what the mechanism can do at all, by size, gear, friction and torque."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import tyro

from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.core.printing import say

MAP = "capability.json"


def capability(
    obstacle: Annotated[
        str, tyro.conf.Positional, tyro.conf.arg(metavar="{narrow-channel,low-entrance,step}")
    ] = "step",
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")],
    sizes: tuple[float, ...] = (),
    gears: tuple[str, ...] = (),
    frictions: tuple[float, ...] = (),
    torques: tuple[float, ...] = (),
    config: ConfigFile = None,
    set: Assignments = (),  # noqa: A002 - the option's name
    processes: int = 2,
) -> int:
    """Search for scripted manoeuvres and map which sizes they overcome.

    Writes capability.json (with every manoeuvre found) as the columns of the map end, and a figure
    of it. Calling it again goes on with the columns that are missing; other gears, frictions and
    torques add columns to the map.

    Args:
        obstacle: The obstacle.
        out: Folder for the map.
        sizes: Sizes in mm from easy to hard; they may leave the paper's range.
        gears: Running gears: wheels, whegs, both.
        frictions: Coefficients of friction of tyres and spokes.
        torques: Factors on all servos' torque limits.
        config: TOML or JSON file of options to change, such as search.population = 200.
        set: Option to change, as key=value; may be repeated; overrides the file.
        processes: Worker processes of one thread each.
    """
    say(f"Searching the {obstacle}; the first size takes a while", file=sys.stderr)
    from surmount.core.configuration import override
    from surmount.studies.capability import CapabilityConfig, map_capability
    from surmount.studies.capability_figure import write_capability_figure
    from surmount.workflow.provenance import provenance
    from surmount.workflow.store import output_errors, sole_user

    given: dict[str, Any] = {
        "sizes_mm": sizes,
        "gears": gears,
        "frictions": frictions,
        "torque_factors": torques,
    }
    chosen = override(
        CapabilityConfig(obstacle=obstacle),
        {**overrides(config, set), **{name: value for name, value in given.items() if value}},
    )
    with sole_user(out), output_errors(out):
        record = map_capability(
            chosen,
            out / MAP,
            provenance=provenance(),
            processes=processes,
            say=print,
        )
        write_capability_figure(record, out)
    say(f"Written to {out}: {MAP}, capability.svg, capability.png, capability.csv")
    return 0
