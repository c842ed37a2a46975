"""RSTAR, the robot of the paper, and its obstacles.

Importing this package registers ``surmount/NarrowChannel-v0``, ``surmount/LowEntrance-v0`` and
``surmount/Step-v0`` with Gymnasium, each with a batched vector environment.
"""

from gymnasium.envs.registration import register, registry

from surmount.rstar.course.obstacles import OBSTACLES

for _obstacle in OBSTACLES.values():
    if _obstacle.gym_id not in registry:
        register(
            id=_obstacle.gym_id,
            entry_point="surmount.rstar.course.single:ObstacleEnv",
            vector_entry_point="surmount.rstar.course.batch:ObstacleVectorEnv",
            kwargs={"obstacle": _obstacle.name},
        )
