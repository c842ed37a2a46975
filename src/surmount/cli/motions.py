"""The motions that `surmount render` and `surmount view` show."""

from __future__ import annotations

import torch

from surmount.cli.options import environment_overrides
from surmount.cli.showing import Shown
from surmount.core.errors import ConfigError
from surmount.core.printing import say
from surmount.rstar.film.footage import Wanted, motions
from surmount.rstar.film.motion import Motion


def shown_motions(shown: Shown) -> list[Motion]:
    """Return the motions that the options choose, and say how each ended."""
    torch.set_num_threads(1)  # as in a run: sums would differ in their last bits
    wanted = Wanted(
        source=shown.source,
        task=shown.task,
        stage=shown.stage,
        sizes_mm=_sizes_mm(shown.variant),
        trials=shown.trial,
        network=shown.network,
        seed=shown.seed,
        deterministic=shown.deterministic,
        standing=shown.stand,
        changes=environment_overrides(shown.config, shown.set, whole_file=True),
    )
    found: list[Motion] = []
    for motion in motions(wanted):
        found.append(motion)
        size = f"{motion.obstacle.name}, {motion.size_mm:g} mm"
        say(f"{size}: {motion.caption}: {motion.outcome}")
    return found


def _sizes_mm(values: tuple[str, ...]) -> tuple[float, ...]:
    try:
        return tuple(map(float, values))
    except ValueError as error:
        raise ConfigError(
            f"`--variant {' '.join(values)}` is no size ({error}).",
            remedy="Give sizes of the obstacle in mm, such as 180.",
        ) from error
