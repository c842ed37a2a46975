"""What may differ from episode to episode or be noisy, for policies that shall leave simulation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import ConfigError
from surmount.rstar.robot.config import require_range

Range = tuple[float, float]

FACTORS = (
    "friction_factor",
    "mass_factor",
    "sprawl_gain_factor",
    "fbem_gain_factor",
    "wheel_gain_factor",
)
"""Factors on the robot's dynamics, in the order in which they are drawn and reported."""

LONGEST_DELAY = 100
"""Steps by which an action may be delayed at the most."""


@dataclass(frozen=True, kw_only=True)
class RandomisationConfig:
    """Randomised dynamics, noisy sensors and late actions; all off by default, as in the paper.

    Ranges hold their two ends, both included. Factors multiply what ``robot`` says and are drawn
    uniformly at every reset, like the delay; noise is normal, without bias, and drawn anew for
    every observation. Rewards, endings, features and all other infos stay free of noise.
    """

    friction_factor: Range = (1.0, 1.0)
    """Range of the factor on the sliding friction of all of the robot's parts, dimensionless: it
    stands for the ground's friction; assumed constant, as in the paper."""
    mass_factor: Range = (1.0, 1.0)
    """Range of the factor on the masses and inertias of all of the robot's parts, dimensionless;
    assumed constant, as in the paper."""
    sprawl_gain_factor: Range = (1.0, 1.0)
    """Range of the factor on stiffness and damping of both sprawl servos, dimensionless; assumed
    constant, as in the paper."""
    fbem_gain_factor: Range = (1.0, 1.0)
    """Range of the factor on stiffness and damping of both FBEM servos, dimensionless; assumed
    constant, as in the paper."""
    wheel_gain_factor: Range = (1.0, 1.0)
    """Range of the factor on the damping of all wheel servos, dimensionless; assumed constant, as
    in the paper. The bound that ``RobotConfig`` states for damping holds for the product."""
    action_delay_steps: tuple[int, int] = (0, 0)
    """Range of the delay between a step and its effect, in whole steps; until the first
    action arrives, the targets rest. The paper has none."""
    attitude_noise_deg: float = 0.0
    """Standard deviation of observed yaw and pitch in degrees; the paper has none."""
    joint_noise_deg: float = 0.0
    """Standard deviation of observed sprawl and FBEM angles in degrees; the paper has none."""
    speed_noise_mps: float = 0.0
    """Standard deviation of the observed tangential speed in m/s; the paper has none."""
    distance_noise_m: float = 0.0
    """Standard deviation of the observed distance to the obstacle in m; the paper has none."""
    size_noise_mm: float = 0.0
    """Standard deviation of the observed obstacle's size in mm; the paper has none."""

    def __post_init__(self) -> None:
        for name in FACTORS:
            low, high = getattr(self, name)
            require_range(f"randomisation.{name}", low, 0.0, 10.0, open_low=True)
            require_range(f"randomisation.{name}", high, low, 10.0)
        low, high = self.action_delay_steps
        if not 0 <= low <= high <= LONGEST_DELAY:
            raise ConfigError(
                f"`randomisation.action_delay_steps` is {self.action_delay_steps!r}.",
                remedy=f"Give two whole numbers from 0 to {LONGEST_DELAY}, the smaller one first.",
            )
        require_range("randomisation.attitude_noise_deg", self.attitude_noise_deg, 0.0, 90.0)
        require_range("randomisation.joint_noise_deg", self.joint_noise_deg, 0.0, 90.0)
        require_range("randomisation.speed_noise_mps", self.speed_noise_mps, 0.0, 1.0)
        require_range("randomisation.distance_noise_m", self.distance_noise_m, 0.0, 1.0)
        require_range("randomisation.size_noise_mm", self.size_noise_mm, 0.0, 100.0)

    @property
    def is_off(self) -> bool:
        """Whether nothing is randomised."""
        return not (self.varies_dynamics or self.delays or self.is_noisy)

    @property
    def varies_dynamics(self) -> bool:
        """Whether any factor may differ from one."""
        return any(getattr(self, name) != (1.0, 1.0) for name in FACTORS)

    @property
    def delays(self) -> bool:
        """Whether actions may be late."""
        return self.action_delay_steps != (0, 0)

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviation of each observation term that is measured, by its name, in its unit.

        The servos' targets are known, not measured: they have none.
        """
        return {
            "yaw": self.attitude_noise_deg,
            "pitch": self.attitude_noise_deg,
            "fbem": self.joint_noise_deg,
            "sprawl": self.joint_noise_deg,
            "speed": self.speed_noise_mps,
            "distance": self.distance_noise_m,
            "size": self.size_noise_mm,
        }

    @property
    def is_noisy(self) -> bool:
        """Whether any observation is noisy."""
        return any(self.deviations.values())


def draw(config: RandomisationConfig, rng: np.random.Generator) -> tuple[FloatArray, int]:
    """Draw an episode's factors, in the order of :data:`FACTORS`, and its delay in steps.

    All are drawn whenever anything is randomised, so that widening one range leaves the draws of
    the others as they were.
    """
    ranges = np.array([getattr(config, name) for name in FACTORS])
    low, high = ranges[:, 0], ranges[:, 1]
    factors = low + rng.random(len(FACTORS)) * (high - low)
    shortest, longest = config.action_delay_steps
    return factors, int(rng.integers(shortest, longest + 1))
