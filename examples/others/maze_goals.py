"""Gymnasium-Robotics' point maze over the way to the goal: a goal environment, SAC with HER.

surmount check maze_goals:make_env
surmount reproduce maze_goals:make_env --preset smoke --config maze_goals.toml --out runs/maze
"""

import gymnasium
import gymnasium_robotics

from surmount import TaskEnv, TaskSpace

gymnasium.register_envs(gymnasium_robotics)
WAY = ((1, 1), (1, 2), (1, 3), (2, 3), (3, 3), (3, 2), (3, 1))
"""Row and column of the cells of the U-shaped maze from the start on."""


class GoalOnTheWay(gymnasium.Wrapper):
    """Turns a task into the maze's own options."""

    def reset(self, *, seed=None, options=None):
        """Begin at the start, with the goal so many cells along the way."""
        cells = options["task"]["way_cells"]
        return self.env.reset(seed=seed, options={"reset_cell": WAY[0], "goal_cell": WAY[cells]})


def make_env():
    maze = gymnasium.make(
        "PointMaze_UMaze-v3",
        max_episode_steps=80,
        continuing_task=False,
        render_mode="rgb_array",  # to be given here: the maze hands it on to the point's simulation
    )
    return TaskEnv(
        GoalOnTheWay(maze),
        space=TaskSpace.grid(way_cells=[1, 2, 3, 4, 5, 6], harder={"way_cells": 1}),
        set_task="task",
        success="success",
        features={
            "x_m": lambda transition: transition.observation["achieved_goal"][0],
            "y_m": lambda transition: transition.observation["achieved_goal"][1],
        },
        step_s=0.1,
    )
