"""The kinds of obstacles as one task space: what tells them apart, and sizes on a common axis."""

from __future__ import annotations

from dataclasses import replace

from surmount.core.arrays import FloatArray
from surmount.core.axis import CONTINUOUS, Axis
from surmount.rstar.course.obstacles import OBSTACLES, Obstacle

PARAMETERS = ("obstacle", "hardness")
"""The kind of obstacle, and how hard its size is: 0 the easiest of its kind, 1 the hardest."""
KINDS: tuple[Obstacle, ...] = tuple(
    # One layout for all: pitch, which the paper's robot observes at the step only, everywhere.
    replace(obstacle, observes_pitch=True)
    for obstacle in OBSTACLES.values()
)
AXES = (Axis(kind="categorical", names=tuple(kind.name for kind in KINDS)), CONTINUOUS)


def sizes_mm(kind: Obstacle, hardness: FloatArray) -> FloatArray:
    """Return the sizes of one kind of obstacle, of any shape; the inverse of :func:`hardness`."""
    easiest = kind.lower + kind.upper - kind.hardest
    return easiest + hardness * (kind.hardest - easiest)


def hardness(kind: Obstacle, sizes: FloatArray) -> FloatArray:
    """Return where sizes in mm lie between the easiest, 0, and the hardest, 1, of any shape."""
    easiest = kind.lower + kind.upper - kind.hardest
    return (sizes - easiest) / (kind.hardest - easiest) + 0.0  # never -0
