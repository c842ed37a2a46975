"""A small environment of somebody's own: drive a point against wind to a distance."""

from __future__ import annotations

import gymnasium
import numpy as np

from surmount.envs.task_env import TaskEnv
from surmount.tasks.space import TaskSpace


class PointEnv(gymnasium.Env):
    """The goal is known to the simulation alone; info tells whether it is reached."""

    metadata = {"render_modes": [], "render_fps": 20}  # noqa: RUF012 - Gymnasium's way

    def __init__(self):
        self.observation_space = gymnasium.spaces.Box(-20, 20, (2,), np.float32)
        self.action_space = gymnasium.spaces.Box(-1, 1, (1,), np.float32)
        self.goal = 1.0
        self.wind = 0.0
        self.task_of_reset = None

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.task_of_reset = dict(options or {})
        self.position = float(self.np_random.uniform(-0.1, 0.1))
        return self._observe(), {"reached": False}

    def step(self, action):
        self.position += 0.2 * float(np.clip(action[0], -1, 1)) - 0.05 * self.wind
        gap = abs(self.goal - self.position)
        reached = gap < 0.15
        return (
            self._observe(),
            (5.0 if reached else -0.1 * gap),
            reached,
            False,
            {"reached": reached},
        )

    def _observe(self):
        return np.array([self.position, self.goal - self.position], dtype=np.float32)


def set_task(env, task):
    env.goal = task["distance_m"]
    env.wind = task["wind"]


def make_point(env=None, **changes):
    contract = {
        "space": TaskSpace.grid(distance_m=[0.5, 1.0, 1.5, 2.0], wind=[0.0, 1.0, 2.0]),
        "set_task": set_task,
        "success": "reached",
        "features": {"position_m": lambda transition: transition.observation[0]},
        "end_on_success": False,
    }
    inner = gymnasium.wrappers.TimeLimit(env or PointEnv(), 12)
    return TaskEnv(inner, **(contract | changes))


if "surmount-tests/Point-v0" not in gymnasium.registry:
    gymnasium.register("surmount-tests/Point-v0", entry_point=PointEnv, max_episode_steps=12)


def make_env():
    env = gymnasium.make("surmount-tests/Point-v0", disable_env_checker=True)
    return TaskEnv(
        env,
        space=TaskSpace.grid(distance_m=[0.5, 1.0, 1.5, 2.0], wind=[0.0, 1.0, 2.0]),
        set_task=set_task,
        success="reached",
        features={"position_m": lambda transition: transition.observation[0]},
    )
