"""Scripted manoeuvres: a few phases of speed, FBEM and sprawl, switched by position or time.

They show what the mechanism can do on an obstacle at all, whatever a learner finds: the evidence
on which friction and running gear are chosen (``docs/adr/0020-physics-by-capability.md``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Self

import numpy as np

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.rstar.robot import constants as c

RATES = np.array([c.ACCELERATION_MPS2, c.FBEM_RATE_DEGPS, c.SPRAWL_RATE_DEGPS])
"""Change of each target at a full action, per second: m/s, degrees, degrees."""
LOWER = np.array([-c.SPEED_MAX_MPS, -c.FBEM_MAX_DEG, c.SPRAWL_MIN_DEG])
UPPER = np.array([c.SPEED_MAX_MPS, c.FBEM_MAX_DEG, c.SPRAWL_MAX_DEG])
START = np.array([0.0, c.START_FBEM_DEG, c.START_SPRAWL_DEG])
"""Targets at the fixed start pose."""


@dataclass(frozen=True, kw_only=True)
class Phase:
    """Targets that are held until the robot has come so far, or for so long.

    Attributes
    ----------
    speed_mps, fbem_deg, sprawl_deg
        Targets, approached at the limits of rate.
    until_x_m
        Position of the base along the course, from the obstacle's front face, in m, at which the
        next phase begins.
    at_most_s
        Time in s after which the next phase begins at the latest.
    """

    speed_mps: float
    fbem_deg: float
    sprawl_deg: float
    until_x_m: float
    at_most_s: float


@dataclass(frozen=True, kw_only=True)
class Manoeuvre:
    """Phases in order, from the fixed start pose; the last one is held to the end."""

    phases: tuple[Phase, ...]

    def __post_init__(self) -> None:
        if not self.phases:
            raise InputError("A manoeuvre has no phases.", remedy="Give at least one phase.")
        values = np.array([list(asdict(phase).values()) for phase in self.phases], dtype=np.float64)
        if not np.isfinite(values).all():
            raise InputError(
                "A manoeuvre holds NaN or infinite values.", remedy="Give finite numbers."
            )
        if (values[:, :3] < LOWER).any() or (values[:, :3] > UPPER).any():
            raise InputError(
                "A manoeuvre's targets leave the robot's ranges.",
                remedy=f"Speed, FBEM and sprawl range from {LOWER.tolist()} to {UPPER.tolist()} "
                "(m/s, degrees, degrees).",
            )

    def to_record(self) -> list[dict[str, float]]:
        """Return the JSON form: a list of phases."""
        return [asdict(phase) for phase in self.phases]

    @classmethod
    def from_record(cls, record: Sequence[Mapping[str, Any]]) -> Self:
        """Build from the JSON form.

        Raises
        ------
        InputError
            If a field is missing, unknown or not a number, or the manoeuvre is not valid.
        """
        try:
            phases = tuple(
                Phase(**{name: float(value) for name, value in phase.items()}) for phase in record
            )
        except (TypeError, ValueError, AttributeError) as error:
            raise InputError(
                f"This is not a manoeuvre ({error}).",
                remedy="A manoeuvre is a list of phases with speed_mps, fbem_deg, sprawl_deg, "
                "until_x_m and at_most_s.",
            ) from error
        return cls(phases=phases)


class Player:
    """Turns manoeuvres into actions, one manoeuvre per environment.

    Parameters
    ----------
    manoeuvres
        One per environment, all begun at the fixed start pose.
    step_s
        Time between two steps in s.
    """

    def __init__(self, manoeuvres: Sequence[Manoeuvre], step_s: float) -> None:
        longest = max(len(manoeuvre.phases) for manoeuvre in manoeuvres)
        rows = [
            [list(asdict(phase).values()) for phase in manoeuvre.phases] for manoeuvre in manoeuvres
        ]
        # Shorter manoeuvres hold their last phase.
        table = np.array([row + [row[-1]] * (longest - len(row)) for row in rows])
        self._targets: FloatArray = table[:, :, :3]
        self._until_x_m: FloatArray = table[:, :, 3]
        self._at_most_s: FloatArray = table[:, :, 4]
        self._interval_s = step_s
        self._envs: IntArray = np.arange(len(rows))
        self._phase: IntArray = np.zeros(len(rows), dtype=np.int64)
        self._in_phase_s: FloatArray = np.zeros(len(rows))
        self._commanded: FloatArray = np.tile(START, (len(rows), 1))

    @property
    def phase(self) -> IntArray:
        """Index of the phase that each environment is in, shape ``(env,)``."""
        return self._phase

    def act(self, x_m: FloatArray) -> FloatArray:
        """Return the actions of this step, in [−1, 1], shape ``(env, 3)``.

        Parameters
        ----------
        x_m
            Position of the base along the course from the front face, in m, shape ``(env,)``.
        """
        over = (x_m >= self._until_x_m[self._envs, self._phase]) | (
            self._in_phase_s >= self._at_most_s[self._envs, self._phase] - 1e-9
        )
        over &= self._phase < self._targets.shape[1] - 1
        self._phase = self._phase + over
        self._in_phase_s = np.where(over, 0.0, self._in_phase_s) + self._interval_s
        reach = RATES * self._interval_s
        missing = self._targets[self._envs, self._phase] - self._commanded
        actions = np.clip(missing / reach, -1.0, 1.0)
        self._commanded = np.clip(self._commanded + actions * reach, LOWER, UPPER)
        return actions
