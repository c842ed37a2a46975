"""A walk along a line to a goal, with actions and observations of any kind: a few hundred bytes."""

from __future__ import annotations

import gymnasium
import numpy as np

from surmount.envs.task_env import TaskEnv
from surmount.tasks.space import TaskSpace

spaces = gymnasium.spaces
ACTIONS = {
    "box": spaces.Box(-1, 1, (1,), np.float32),
    "discrete": spaces.Discrete(3),
    "multidiscrete": spaces.MultiDiscrete([3, 2]),
    "multibinary": spaces.MultiBinary(2),
}
OBSERVATIONS = {
    "box": spaces.Box(-10, 10, (2,), np.float32),
    "discrete": spaces.Discrete(21),
    "dict": spaces.Dict(
        place=spaces.Box(-10, 10, (2,), np.float32), side=spaces.Discrete(2), said=spaces.Text(9)
    ),
    "image": spaces.Box(0, 255, (12, 12, 1), np.uint8),
    "goal": spaces.Dict(
        observation=spaces.Box(-10, 10, (1,), np.float32),
        achieved_goal=spaces.Box(-10, 10, (1,), np.float32),
        desired_goal=spaces.Box(-10, 10, (1,), np.float32),
    ),
}


class Walk(gymnasium.Env):
    """Steps of at most 0.5 to a goal that the task places."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012 - Gymnasium's way

    def __init__(self, actions="box", observations="box"):
        self.action_space = ACTIONS[actions]
        self.observation_space = OBSERVATIONS[observations]
        self.render_mode = "rgb_array"
        self.kind, self.seen = actions, observations
        self.goal = 1.0

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.place = float(self.np_random.uniform(-0.2, 0.2))
        return self._observe(), {"there": False}

    def step(self, action):
        self.place += (
            0.5
            * {
                "box": lambda: float(np.clip(action[0], -1, 1)),
                "discrete": lambda: float(action) - 1.0,
                "multidiscrete": lambda: float(action[0]) - 1.0,
                "multibinary": lambda: float(action[0]) - float(action[1]),
            }[self.kind]()
        )
        there = abs(self.place - self.goal) < 0.3
        return self._observe(), self.compute_reward(self.place, self.goal, {}), there, False, {
            "there": there
        }  # fmt: skip

    def compute_reward(self, achieved, desired, info):
        gap = np.abs(np.asarray(achieved) - np.asarray(desired))
        return np.where(gap < 0.3, 1.0, -0.1 * gap).squeeze(-1) if gap.ndim > 1 else (
            float(np.where(gap < 0.3, 1.0, -0.1 * gap))
        )  # fmt: skip

    def render(self):
        frame = np.zeros((32, 64, 3), np.uint8)
        frame[:, int(np.clip(32 + 8 * self.place, 0, 63))] = 255
        return frame

    def _observe(self):
        place, gap = np.float32(self.place), np.float32(self.goal - self.place)
        if self.seen == "box":
            return np.array([place, gap], np.float32)
        if self.seen == "discrete":
            return int(np.clip(10 + round(4 * float(gap)), 0, 20))
        if self.seen == "dict":
            return {"place": np.array([place, gap], np.float32), "side": int(gap > 0), "said": "go"}
        if self.seen == "goal":
            return {
                "observation": np.array([place], np.float32),
                "achieved_goal": np.array([place], np.float32),
                "desired_goal": np.array([self.goal], np.float32),
            }
        image = np.zeros((12, 12, 1), np.uint8)
        image[:, int(np.clip(6 + 2 * gap, 0, 11))] = 255
        return image


def make_walk(actions="box", observations="box", **changes) -> TaskEnv:
    contract = {
        "space": TaskSpace.grid(goal_m=[0.5, 1.0, 2.0]),
        "set_task": lambda env, task: setattr(env, "goal", task["goal_m"]),
        "success": "there",
        "features": {"place_m": lambda moment: moment.env.place},
        "end_on_success": True,
    }
    inner = gymnasium.wrappers.TimeLimit(Walk(actions, observations), 15)
    return TaskEnv(inner, **(contract | changes))


def discrete() -> TaskEnv:
    return make_walk("discrete")


def goals() -> TaskEnv:
    return make_walk("box", "goal")


def pictures() -> TaskEnv:
    return make_walk("discrete", "image")
