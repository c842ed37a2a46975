"""RSTAR, the robot of the paper, and its obstacles.

Importing this package registers ``surmount/NarrowChannel-v0``, ``surmount/LowEntrance-v0`` and
``surmount/Step-v0`` with Gymnasium, each with a batched vector environment.
"""

from surmount.rstar.course.obstacles import OBSTACLES


def _register() -> None:
    try:
        from gymnasium.envs.registration import register, registry  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:  # pages of finished runs do without it
        return
    for obstacle in OBSTACLES.values():
        if obstacle.gym_id not in registry:
            register(
                id=obstacle.gym_id,
                entry_point="surmount.rstar.course.single:ObstacleEnv",
                vector_entry_point="surmount.rstar.course.batch:ObstacleVectorEnv",
                kwargs={"obstacle": obstacle.name},
            )


_register()
