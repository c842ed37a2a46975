"""RSTAR with all three obstacles: one policy, the kind of obstacle a task parameter.

Between kinds there is no distance: a step of 40 mm is no nearer to a channel than to an entrance.
Sizes of different ranges share one axis, from the easiest of their kind to the hardest.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import cast

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.envs.family import TaskFamily
from surmount.envs.vector_env import TaskVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.kinds import AXES, KINDS, PARAMETERS, hardness
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.family import CALIBRATED, DIVERGED_REMEDY, INITIAL_STEPS
from surmount.tasks.space import TaskSpace


class AllObstaclesFamily(TaskFamily):
    """The 15 channels, 18 entrances and 30 steps of the paper."""

    name = "rstar/all"
    title = "RSTAR and all three obstacles"
    settings = EnvConfig
    calibrated = CALIBRATED
    diverged_remedy = DIVERGED_REMEDY
    initial_steps = sum(INITIAL_STEPS.values())
    """As many as those of the three obstacles together (paper III-C)."""

    def space(self, settings: EnvConfig) -> TaskSpace:
        """Return kind and hardness; which kind is harder nobody knows."""
        del settings
        variants = [
            (place, share)
            for place, kind in enumerate(KINDS)
            for share in np.sort(hardness(kind, kind.variants)).tolist()
        ]
        return TaskSpace(
            parameters=PARAMETERS,
            lower=np.zeros(2),
            upper=np.array([len(KINDS) - 1.0, 1.0]),
            variants=np.array(variants),
            axes=AXES,
        )

    def difficulty(self, variants: FloatArray) -> FloatArray:
        """Return the hardness, by which the hard third is hard in each kind."""
        return variants[:, 1]

    def fingerprint(self, settings: EnvConfig) -> str:
        """Return the SHA-256 of the three courses as MuJoCo's XML, and of what tells them apart."""
        from surmount.rstar.course.scene import model_hash  # noqa: PLC0415 - MuJoCo

        models = "".join(model_hash(obstacle, settings) for obstacle in OBSTACLES.values())
        return hashlib.sha256(f"kinds by one number each; {models}".encode()).hexdigest()

    def cap_s(self, settings: EnvConfig) -> float:
        """Return the cap of an episode in s."""
        return settings.episode_s

    def training_env(self, settings: EnvConfig, num_envs: int) -> TaskVectorEnv:
        """Build courses whose episodes begin at random starts."""
        return _built(settings, num_envs, autoreset=True, start="random")

    def trial_env(self, settings: EnvConfig, num_envs: int) -> TaskVectorEnv:
        """Build courses whose episodes begin at the fixed start pose (III-D)."""
        return _built(settings, num_envs, autoreset=False, start="fixed")

    def draw_films(self, run: Path, say: Callable[[str], None]) -> None:
        """Draw none: films replay the trials of a single obstacle."""
        del run, say


def _built(settings: EnvConfig, num_envs: int, *, autoreset: bool, start: str) -> TaskVectorEnv:
    from surmount.rstar.course.mixed import MixedVectorEnv  # noqa: PLC0415 - MuJoCo

    env = MixedVectorEnv(num_envs, config=settings, autoreset=autoreset, start=start)
    return cast(TaskVectorEnv, env)
