"""RSTAR's obstacles as families of tasks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from surmount.envs.family import TaskFamily
from surmount.envs.vector_env import TaskVectorEnv
from surmount.learn.presets import ML_AGENTS
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import OBSTACLES, Obstacle
from surmount.tasks.space import TaskSpace
from surmount.workflow.run_folder import open_run

CALIBRATED: Mapping[str, Any] = MappingProxyType(
    {
        **ML_AGENTS,
        "learner.discount_time_s": 5.0,
        "learner.gae_time_s": 0.5,
        "env.robot.friction": 1.3,
    }
)
"""Under which the initiation is most like the paper's, one choice for all obstacles (ADR 23)."""

INITIAL_STEPS = {"narrow-channel": 500_000, "low-entrance": 500_000, "step": 1_000_000}
"""Learning steps of the initiation (paper III-C)."""


DIVERGED_REMEDY = "Shorten the physics step, `env.robot.physics_step_s`."


class ObstacleFamily(TaskFamily):
    """The variants of one of RSTAR's obstacles (paper III-C).

    MuJoCo is imported when it is needed: pages of finished runs do without it.

    Parameters
    ----------
    obstacle
        The obstacle.
    """

    settings = EnvConfig
    calibrated = CALIBRATED
    diverged_remedy = DIVERGED_REMEDY

    def __init__(self, obstacle: Obstacle) -> None:
        self.obstacle = obstacle
        self.name = f"rstar/{obstacle.name}"
        self.title = f"RSTAR and the {obstacle.name.replace('-', ' ')}"
        self.initial_steps = INITIAL_STEPS[obstacle.name]

    def space(self, settings: EnvConfig) -> TaskSpace:
        """Return the size of the obstacle in mm."""
        del settings
        return TaskSpace(
            parameters=(self.obstacle.parameter,),
            lower=np.array([self.obstacle.lower]),
            upper=np.array([self.obstacle.upper]),
            variants=self.obstacle.variants[:, None],
            harder=(self.obstacle.harder,),
        )

    def fingerprint(self, settings: EnvConfig) -> str:
        """Return the SHA-256 of robot and course as MuJoCo's XML."""
        from surmount.rstar.course.scene import model_hash  # noqa: PLC0415 - see the class

        return model_hash(self.obstacle, settings)

    def cap_s(self, settings: EnvConfig) -> float:
        """Return the cap of an episode in s."""
        return settings.episode_s

    def training_env(self, settings: EnvConfig, num_envs: int) -> TaskVectorEnv:
        """Build courses whose episodes begin at random starts."""
        return self._built(settings, num_envs, autoreset_mode="SameStep", start="random")

    def trial_env(self, settings: EnvConfig, num_envs: int) -> TaskVectorEnv:
        """Build courses whose episodes begin at the fixed start pose (III-D)."""
        return self._built(settings, num_envs, autoreset_mode="Disabled", start="fixed")

    def draw_films(self, run: Path, say: Callable[[str], None]) -> None:
        """Draw one trial on the hardest variant before, with and without the curriculum."""
        from surmount.rstar.film.run_films import draw_films  # noqa: PLC0415 - needs extras

        draw_films(open_run(run), say)

    def _built(
        self, settings: EnvConfig, num_envs: int, *, autoreset_mode: str, start: str
    ) -> TaskVectorEnv:
        from surmount.rstar.course.batch import ObstacleVectorEnv  # noqa: PLC0415 - see the class

        return ObstacleVectorEnv(
            self.obstacle.name,
            num_envs,
            config=settings,
            n_threads=1,  # stages run side by side (ADR 3)
            autoreset_mode=autoreset_mode,
            start=start,
        )


FAMILIES = {name: ObstacleFamily(obstacle) for name, obstacle in OBSTACLES.items()}
"""By the name of the obstacle."""
