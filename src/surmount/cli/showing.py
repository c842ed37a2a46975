"""Options that choose what `surmount render` and `surmount view` show."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import tyro

from surmount.cli.options import Assignments, ConfigFile


@dataclass(frozen=True, kw_only=True)
class Shown:
    """Options that choose what is shown."""

    source: Annotated[str, tyro.conf.Positional]
    """An obstacle (narrow-channel, low-entrance, step), shown with its stored manoeuvre; or a
    path: a run's folder, a network.safetensors, a table of trials, a manoeuvre in JSON."""
    task: Annotated[str | None, tyro.conf.arg(metavar="{narrow-channel,low-entrance,step}")] = None
    """Obstacle that a file belongs to; not needed for files of a run."""
    stage: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None
    """Stage of a run's folder, such as curriculum/network-0 for the network trained there, or
    test-curriculum/network-0 for trials; the furthest trained network 0 if left out."""
    variant: Annotated[tuple[str, ...], tyro.conf.arg(metavar="VALUE ...")] = ()
    """Sizes of the obstacle in mm, or tasks of your own environment as `surmount evaluate` takes
    them, one after the other; the hardest, or the last, if left out."""
    trial: Annotated[tuple[int, ...], tyro.conf.arg(metavar="N ...")] = ()
    """Numbers of logged trials, one after the other; the first if left out."""
    network: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Network of a table of several networks' trials; the first if left out."""
    seed: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Seed of the actions that a policy draws; 0 if left out."""
    deterministic: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Let a policy act by its mean instead of drawing its actions, as trials do."""
    stand: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Let the robot stand at its start."""
    config: ConfigFile = None
    """TOML or JSON file of configuration keys to change; see `surmount config`."""
    set: Assignments = field(default=())
    """Configuration key to change, as key=value; may be repeated; overrides the file."""
