"""The three obstacle families: names, ranges, variants, and where their blocks stand.

Obstacles are *mocap* bodies: their positions belong to the simulation state, so one compiled model
serves every variant, and a batch of simulations can hold a different variant in each.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError, InputError
from surmount.rstar.course.config import CourseConfig
from surmount.rstar.robot import kinematics
from surmount.rstar.robot.kinematics import Gear

WALL_HEIGHT_M = 0.15
"""Height of the channel's walls: above the tallest robot (125 mm)."""
WALL_THICKNESS_M = 0.12
"""Thickness of the channel's walls: less than a robot's width remains to the floor's edge."""
LINTEL_HEIGHT_M = 0.06
"""Height of the entrance's block, from its lower to its upper face."""
POST_THICKNESS_M = 0.02
"""Width of the posts on both sides that the entrance's block slides along."""
POST_HEIGHT_M = 0.22
"""Height of the posts: above the highest entrance's block."""
STEP_HEIGHT_M = 0.10
"""Height of the step's block, of which the variant's height shows above the floor."""
CLEARANCE_M = 0.003
"""Gap to the obstacle that a drawn start must leave on every side."""

ObstacleName = Literal["narrow-channel", "low-entrance", "step"]


@dataclass(frozen=True, kw_only=True)
class Block:
    """A box of an obstacle: name of its mocap body and half sizes in m."""

    name: str
    half_size_m: tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Obstacle:
    """A family of obstacles that differ in one size.

    Attributes
    ----------
    name
        Name of the family.
    gym_id
        Identifier of the registered environment.
    parameter
        Name of the size with its unit.
    lower, upper
        Range of the size in mm, from which training draws.
    spacing
        Distance between the variants that are tested, in mm.
    observes_pitch
        Whether pitch is observed; in the paper at the step only.
    harder
        1 where larger sizes are harder, −1 where smaller ones are.
    """

    name: ObstacleName
    gym_id: str
    parameter: str
    lower: float
    upper: float
    spacing: float
    observes_pitch: bool
    harder: Literal[1, -1]

    @property
    def variants(self) -> FloatArray:
        """Sizes that are tested, in mm, shape ``(variant,)``."""
        count = round((self.upper - self.lower) / self.spacing) + 1
        return self.lower + self.spacing * np.arange(count, dtype=np.float64)

    @property
    def hardest(self) -> float:
        """Hardest size in mm: the highest step, the narrowest channel, the lowest entrance."""
        return self.upper if self.harder > 0 else self.lower

    @property
    def admissible(self) -> tuple[float, float]:
        """Sizes that the environment accepts, in mm: the range and one spacing around it."""
        return self.lower - self.spacing, self.upper + self.spacing

    def check_sizes(self, sizes_mm: FloatArray) -> None:
        """Raise :class:`InputError` unless all sizes are admissible."""
        low, high = self.admissible
        inside = (sizes_mm >= low) & (sizes_mm <= high)
        if not inside.all():
            raise InputError(
                f"{self.name}: {self.parameter} {sizes_mm[~inside].flat[0]:g} is not admissible.",
                remedy=f"Give sizes from {low:g} to {high:g} mm.",
            )


OBSTACLES: Mapping[str, Obstacle] = MappingProxyType(
    {
        obstacle.name: obstacle
        for obstacle in (
            Obstacle(
                name="narrow-channel",
                gym_id="surmount/NarrowChannel-v0",
                parameter="width_mm",
                lower=180.0,
                upper=320.0,
                spacing=10.0,
                observes_pitch=False,
                harder=-1,
            ),
            Obstacle(
                name="low-entrance",
                gym_id="surmount/LowEntrance-v0",
                parameter="height_mm",
                lower=55.0,
                upper=140.0,
                spacing=5.0,
                observes_pitch=False,
                harder=-1,
            ),
            Obstacle(
                name="step",
                gym_id="surmount/Step-v0",
                parameter="height_mm",
                lower=21.0,
                upper=50.0,
                spacing=1.0,
                observes_pitch=True,
                harder=1,
            ),
        )
    }
)
"""The paper's obstacle families by name (III-A)."""


def find_obstacle(name: str) -> Obstacle:
    """Return a family by name, or raise :class:`ConfigError`."""
    if name not in OBSTACLES:
        raise ConfigError(
            f"There is no obstacle `{name}`.",
            remedy=f"{nearest(name, [*OBSTACLES])} There are {', '.join(OBSTACLES)}.",
        )
    return OBSTACLES[name]


def blocks(obstacle: Obstacle, course: CourseConfig) -> tuple[Block, ...]:
    """Return the boxes that make up an obstacle."""
    half_length = course.obstacle_length_m / 2
    if obstacle.name == "narrow-channel":
        size = (half_length, WALL_THICKNESS_M / 2, WALL_HEIGHT_M / 2)
        return (
            Block(name="left_wall", half_size_m=size),
            Block(name="right_wall", half_size_m=size),
        )
    if obstacle.name == "low-entrance":
        half_width = course.floor_half_width_m - POST_THICKNESS_M
        size = (half_length, half_width, LINTEL_HEIGHT_M / 2)
        return (Block(name="lintel", half_size_m=size),)
    size = (half_length, course.step_width_m / 2, STEP_HEIGHT_M / 2)
    return (Block(name="step_block", half_size_m=size),)


def block_positions(obstacle: Obstacle, course: CourseConfig, size_mm: FloatArray) -> FloatArray:
    """Return the centres of an obstacle's blocks.

    Parameters
    ----------
    obstacle, course
        Family and course.
    size_mm
        Width or height, shape ``(env,)``.

    Returns
    -------
    FloatArray
        Positions in m, shape ``(env, block, 3)``, blocks in the order of :func:`blocks`.
    """
    size = np.asarray(size_mm, dtype=np.float64) * 1e-3
    positions = np.zeros((size.size, 2 if obstacle.name == "narrow-channel" else 1, 3))
    positions[:, :, 0] = course.obstacle_length_m / 2
    if obstacle.name == "narrow-channel":
        positions[:, 0, 1] = (size + WALL_THICKNESS_M) / 2
        positions[:, 1, 1] = -positions[:, 0, 1]
        positions[:, :, 2] = WALL_HEIGHT_M / 2
    elif obstacle.name == "low-entrance":
        positions[:, 0, 2] = size + LINTEL_HEIGHT_M / 2
    else:
        positions[:, 0, 2] = size - STEP_HEIGHT_M / 2
    return positions


def surface_m(
    obstacle: Obstacle, course: CourseConfig, x_m: float, size_mm: FloatArray
) -> FloatArray:
    """Return the height of what lies under the middle of the course at ``x_m``, in m.

    The floor everywhere, except on a step.

    Parameters
    ----------
    obstacle, course
        Family and course.
    x_m
        Position along the course from the front face, in m.
    size_mm
        Size of each obstacle in mm, of any shape; the result has it too.
    """
    on_top = obstacle.name == "step" and 0.0 <= x_m <= course.obstacle_length_m
    return size_mm * (1e-3 if on_top else 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Poses:
    """Level poses: base position in m, angles in degrees; each field of shape ``(pose,)``."""

    x_m: FloatArray
    y_m: FloatArray
    yaw_deg: FloatArray
    sprawl_deg: FloatArray
    fbem_deg: FloatArray


def ground_m(
    obstacle: Obstacle, course: CourseConfig, size_mm: float, poses: Poses, gear: Gear
) -> tuple[BoolArray, FloatArray]:
    """Return where the robot fits, and the height of the ground it then stands on.

    Returns
    -------
    tuple
        Whether each pose leaves the clearance to the obstacle, and ground height in m; both of
        shape ``(pose,)``. Yaw is not taken into account.
    """
    rear, front = kinematics.fore_aft_extent_mm(poses.fbem_deg)
    rear, front = poses.x_m + rear * 1e-3, poses.x_m + front * 1e-3
    size_m = size_mm * 1e-3
    length = course.obstacle_length_m
    fits = (front < -CLEARANCE_M) | (rear > length + CLEARANCE_M)
    ground = np.zeros(fits.shape)
    if obstacle.name == "narrow-channel":
        half = kinematics.width_mm(poses.sprawl_deg, poses.fbem_deg, gear) * 0.5e-3
        fits |= half + np.abs(poses.y_m) < size_m / 2 - CLEARANCE_M
    elif obstacle.name == "low-entrance":
        height = kinematics.height_mm(poses.sprawl_deg, poses.fbem_deg, gear) * 1e-3
        fits |= height < size_m - CLEARANCE_M
    else:
        on_top = (rear > CLEARANCE_M) & (front < length - CLEARANCE_M)
        ground[on_top] = size_m
        fits |= on_top
    return fits, ground
