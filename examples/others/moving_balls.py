"""MiniGrid's moving obstacles over their number, in pictures: four frames stacked, CnnPolicy.

surmount check moving_balls:make_env
surmount reproduce moving_balls:make_env --preset smoke --config moving_balls.toml --out runs/balls
"""

import gymnasium
import minigrid  # noqa: F401 - registers its environments
from minigrid.wrappers import ImgObsWrapper, RGBImgPartialObsWrapper

from surmount import TaskEnv, TaskSpace


def set_task(env, task):
    env.n_obstacles = task["n_balls"]


def make_env():
    balls = gymnasium.make("MiniGrid-Dynamic-Obstacles-6x6-v0", max_episode_steps=40)
    return TaskEnv(
        ImgObsWrapper(RGBImgPartialObsWrapper(balls, tile_size=6)),  # 42 x 42 pixels
        space=TaskSpace.grid(n_balls=[0, 1, 2, 3], harder={"n_balls": 1}),
        set_task=set_task,
        success=lambda transition: transition.reward > 0,
        features={
            "column": lambda transition: transition.env.agent_pos[0],
            "row": lambda transition: transition.env.agent_pos[1],
            "direction": lambda transition: transition.env.agent_dir,
        },
    )
