"""The obstacle that an experiment is on."""

from __future__ import annotations

from surmount.core.errors import ConfigError
from surmount.experiment.config import ExperimentConfig
from surmount.rstar.course.obstacles import OBSTACLES, Obstacle
from surmount.rstar.family import ObstacleFamily


def obstacle_of(config: ExperimentConfig) -> Obstacle:
    """Return the obstacle that an experiment is on.

    Raises
    ------
    ConfigError
        If it is on another robot's tasks.
    """
    family = config.family
    if not isinstance(family, ObstacleFamily):
        raise ConfigError(
            f"`{family.name}` is none of RSTAR's obstacles.",
            remedy=f"Give one of {', '.join(f'rstar/{name}' for name in OBSTACLES)}.",
        )
    return family.obstacle
