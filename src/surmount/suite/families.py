"""The suite's families of tasks, registered by an entry point as anybody's are."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.envs.family import NoSettings, TaskFamily
from surmount.envs.vector_env import TaskVectorEnv
from surmount.suite import point_mass
from surmount.suite.lander import make_lander
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.space import TaskSpace

POSITIONS = np.linspace(-4.0, 4.0, 9)
"""Positions of the gate that are compared: every unit, the targets' among them."""
WIDTHS = np.array([0.5, 1.0, 2.0, 4.0, 8.0])
"""Widths of the gate that are compared: doubled from the narrowest, the targets', to the widest."""


class PointMassFamily(TaskFamily):
    """The point mass with a gate, over the gate's position and width."""

    name = "suite/point-mass"
    title = "Point mass with a gate"
    initial_steps = 81_920
    """A tenth of the publication's training."""

    def space(self, settings: NoSettings) -> TaskSpace:
        """Return the gates; narrow ones are harder, and no side is."""
        del settings
        variants = np.array([[position, width] for position in POSITIONS for width in WIDTHS])
        return TaskSpace(
            parameters=("gate_position", "gate_width"),
            lower=np.array(point_mass.LOWER),
            upper=np.array(point_mass.UPPER),
            variants=variants,
        )

    def target(self, settings: NoSettings) -> TaskDistribution:
        """Return the publication's target tasks: two narrow gates, within two deviations.

        The half of the normal distributions below the narrowest gate is not of the range.
        """
        del settings
        centres = np.array(point_mass.TARGETS)
        reach = 2 * point_mass.TARGET_DEVIATION
        return TaskDistribution(
            parameters=("gate_position", "gate_width"),
            weights=np.array([0.5, 0.5]),
            lower=centres - np.array([reach, 0.0]),
            upper=centres + reach,
        )

    def published_returns(self) -> Mapping[str, tuple[float, float]]:
        """Return the end of CURROT's curve."""
        return {"currot": point_mass.CURROT_RETURN}

    def difficulty(self, variants: FloatArray) -> FloatArray:
        """Return how far the gate's nearer edge is from the straight way."""
        return np.abs(variants[:, 0]) - 0.5 * variants[:, 1]

    def right_groups(self, variants: FloatArray) -> tuple[tuple[str, ...], IntArray]:
        """Return straight, left and right, the ways that there are."""
        return point_mass.right_groups(variants)

    def fingerprint(self, settings: NoSettings) -> str:
        """Return the SHA-256 of the files that dynamics and environment are written in."""
        del settings
        here = Path(__file__).parent
        text = b"".join(
            (here / name).read_bytes() for name in ("point_mass.py", "point_mass_env.py")
        )
        return hashlib.sha256(text).hexdigest()

    def cap_s(self, settings: NoSettings) -> float:
        """Return the cap of an episode in s."""
        del settings
        return point_mass.EPISODE_STEPS * point_mass.PHYSICS_STEPS * point_mass.PHYSICS_STEP_S

    def training_env(self, settings: NoSettings, num_envs: int) -> TaskVectorEnv:
        """Build masses that begin anew when an episode ends."""
        del settings
        return _masses(num_envs, autoreset=True)

    def trial_env(self, settings: NoSettings, num_envs: int) -> TaskVectorEnv:
        """Build masses that stay where they are when an episode ends."""
        del settings
        return _masses(num_envs, autoreset=False)


def _masses(num_envs: int, *, autoreset: bool) -> TaskVectorEnv:
    # Gymnasium is not there where only finished runs are read.
    from surmount.suite.point_mass_env import PointMassVectorEnv  # noqa: PLC0415

    return PointMassVectorEnv(num_envs, autoreset=autoreset)


FAMILIES: Mapping[str, TaskFamily | Callable[[], Any]] = {
    "lander": make_lander,
    "point-mass": PointMassFamily(),
}
"""What the entry point ``suite`` registers."""
