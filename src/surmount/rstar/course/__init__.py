"""Obstacle courses for RSTAR as Gymnasium environments, single and batched.

Importing this package registers ``surmount/NarrowChannel-v0``, ``surmount/LowEntrance-v0`` and
``surmount/Step-v0`` with Gymnasium, each with a batched vector environment.
"""

from gymnasium.envs.registration import register, registry

from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import CourseConfig, EnvConfig, RewardConfig, StartConfig
from surmount.rstar.course.obstacles import OBSTACLES, Obstacle, find_obstacle
from surmount.rstar.course.randomisation import RandomisationConfig
from surmount.rstar.course.single import ObstacleEnv

for _obstacle in OBSTACLES.values():
    if _obstacle.gym_id not in registry:
        register(
            id=_obstacle.gym_id,
            entry_point="surmount.rstar.course.single:ObstacleEnv",
            vector_entry_point="surmount.rstar.course.batch:ObstacleVectorEnv",
            kwargs={"obstacle": _obstacle.name},
        )

__all__ = [
    "OBSTACLES",
    "CourseConfig",
    "EnvConfig",
    "Obstacle",
    "ObstacleEnv",
    "ObstacleVectorEnv",
    "RandomisationConfig",
    "RewardConfig",
    "StartConfig",
    "find_obstacle",
]
