"""What a policy decides: the entries of an action, and how they reach the servos."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import FloatArray
from surmount.core.errors import InputError
from surmount.rstar.robot import constants as c


@dataclass(frozen=True, kw_only=True)
class ActionTerm:
    """One entry of an action, in [−1, 1]: the rate of a target as a fraction of its limit.

    Attributes
    ----------
    name, symbol, meaning
        Which target. S is the symbol of the paper's eq. 6, the others are this project's.
    unit, lower, upper
        Range of the target.
    rate
        Change of the target at a full action, in units per second.
    """

    name: str
    symbol: str
    meaning: str
    unit: str
    lower: float
    upper: float
    rate: float


ACTION_TERMS = (
    ActionTerm(
        name="speed",
        symbol="S",
        meaning="tangential speed of all wheels",
        unit="m/s",
        lower=-c.SPEED_MAX_MPS,
        upper=c.SPEED_MAX_MPS,
        rate=c.ACCELERATION_MPS2,
    ),
    ActionTerm(
        name="fbem",
        symbol="f",
        meaning="FBEM angle of both sides",
        unit="deg",
        lower=-c.FBEM_MAX_DEG,
        upper=c.FBEM_MAX_DEG,
        rate=c.FBEM_RATE_DEGPS,
    ),
    ActionTerm(
        name="sprawl",
        symbol="s",
        meaning="sprawl angle of both sides",
        unit="deg",
        lower=c.SPRAWL_MIN_DEG,
        upper=c.SPRAWL_MAX_DEG,
        rate=c.SPRAWL_RATE_DEGPS,
    ),
)
"""Entries of an action in the paper's order (III-B)."""

ACTIONS = tuple(term.name for term in ACTION_TERMS)
"""Their names."""

_LOWEST: FloatArray = np.array(-1.0)
_HIGHEST: FloatArray = np.array(1.0)


def checked_actions(actions: npt.ArrayLike, num_envs: int) -> FloatArray:
    """Return actions as numbers clipped to [−1, 1], shape ``(env, action)``.

    Raises
    ------
    InputError
        If they do not fit or are not finite.
    """
    values = np.asarray(actions, dtype=np.float64)
    fits = values.shape == (num_envs, len(ACTIONS))
    if not fits or np.count_nonzero(np.isfinite(values)) < values.size:
        raise InputError(
            f"Actions of shape {values.shape} do not fit or are not finite.",
            remedy=f"Give finite numbers of shape {(num_envs, len(ACTIONS))}.",
        )
    clipped = np.maximum(values, _LOWEST)
    return np.minimum(clipped, _HIGHEST, out=clipped)
