"""What `surmount render` and `surmount view` show, and the options that choose it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import torch
import tyro

from surmount.cli.options import Assignments, ConfigFile, overrides
from surmount.rstar.film.footage import Wanted, motions
from surmount.rstar.film.motion import Motion


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
    variant: Annotated[tuple[float, ...], tyro.conf.arg(metavar="MM ...")] = ()
    """Sizes of the obstacle in mm, one after the other; the hardest if left out."""
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


def shown_motions(shown: Shown) -> list[Motion]:
    """Return the motions that the options choose, and say how each ended."""
    torch.set_num_threads(1)  # as in a run: sums would differ in their last bits
    wanted = Wanted(
        source=shown.source,
        task=shown.task,
        stage=shown.stage,
        sizes_mm=shown.variant,
        trials=shown.trial,
        network=shown.network,
        seed=shown.seed,
        deterministic=shown.deterministic,
        standing=shown.stand,
        changes=overrides(shown.config, shown.set),
    )
    found: list[Motion] = []
    for motion in motions(wanted):
        found.append(motion)
        size = f"{motion.obstacle.name}, {motion.size_mm:g} mm"
        print(f"{size}: {motion.caption}: {motion.outcome}")
    return found
