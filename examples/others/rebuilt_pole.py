"""Gymnasium's inverted pendulum in MuJoCo, whose model is compiled anew for each task.

surmount check rebuilt_pole:make_env
surmount reproduce rebuilt_pole:make_env --preset smoke --config rebuilt_pole.toml --out runs/pole
"""

import mujoco
import numpy as np
from gymnasium.envs.mujoco.inverted_pendulum_v5 import DEFAULT_CAMERA_CONFIG, InvertedPendulumEnv
from gymnasium.envs.mujoco.mujoco_rendering import MujocoRenderer
from gymnasium.wrappers import TimeLimit

from surmount import TaskEnv, TaskSpace


class RebuiltPendulum(InvertedPendulumEnv):
    """Compiles its model with a pole of any length."""

    pole_m = None

    def build(self, pole_m):
        """Put a pole of this length on the cart."""
        if pole_m == self.pole_m:
            return
        spec = mujoco.MjSpec.from_file(self.fullpath)
        spec.geom("cpole").fromto = [0, 0, 0, 0.001, 0, pole_m]
        self.pole_m, self.model = pole_m, spec.compile()
        self.data = mujoco.MjData(self.model)
        self.mujoco_renderer.close()  # it drew the model of before
        self.mujoco_renderer = MujocoRenderer(
            self.model, self.data, DEFAULT_CAMERA_CONFIG, self.width, self.height
        )


def make_env():
    return TaskEnv(
        TimeLimit(RebuiltPendulum(), 100),
        space=TaskSpace.grid(pole_m=np.linspace(0.1, 1.1, 6)),
        set_task=lambda env, task: env.build(task["pole_m"]),
        success=lambda transition: transition.truncated and not transition.terminated,
        features={
            "cart_m": lambda transition: transition.observation[0],
            "tilt_rad": lambda transition: transition.observation[1],
        },
        observe_task=True,
    )
