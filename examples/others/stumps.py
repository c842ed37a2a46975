"""Gymnasium's bipedal walker before a stump, over the stump's height: the terrain is built anew.

surmount check stumps:make_env
surmount reproduce stumps:make_env --preset smoke --config stumps.toml --out runs/stumps
"""

import numpy as np
from gymnasium.envs.box2d.bipedal_walker import TERRAIN_STEP, BipedalWalker
from gymnasium.wrappers import TimeLimit

from surmount import TaskEnv, TaskSpace

STUMP = 14
"""Piece of the terrain that the stump stands on; the walker begins on the tenth."""
GOAL_M = (STUMP + 3) * TERRAIN_STEP


class StumpWalker(BipedalWalker):
    """Walks towards a stump on the otherwise usual terrain."""

    stump_m = 0.5

    def _generate_terrain(self, hardcore):
        super()._generate_terrain(hardcore)
        left, ground = self.terrain_x[STUMP], self.terrain_y[STUMP]
        right, top = left + TERRAIN_STEP, ground + self.stump_m
        self.fd_polygon.shape.vertices = [
            (left, ground), (right, ground), (right, top), (left, top)
        ]  # fmt: skip
        stump = self.world.CreateStaticBody(fixtures=self.fd_polygon)
        stump.color1, stump.color2 = (255, 255, 255), (153, 153, 153)
        self.terrain.append(stump)


def set_task(env, task):
    env.stump_m = task["stump_m"]  # the reset that follows builds the terrain


def make_env():
    return TaskEnv(
        TimeLimit(StumpWalker(), 150),
        space=TaskSpace.grid(stump_m=np.linspace(0.1, 1.1, 6), harder={"stump_m": 1}),
        set_task=set_task,
        success=lambda transition: transition.env.hull.position.x > GOAL_M,
        features={
            "hull_m": lambda transition: transition.env.hull.position.x,
            "height_m": lambda transition: transition.env.hull.position.y,
            "tilt_rad": lambda transition: transition.observation[0],
        },
        end_on_success=True,
    )
