"""Options of an environment's reset, read and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import BoolArray, FloatArray
from surmount.core.errors import InputError
from surmount.rstar.course.obstacles import Obstacle


@dataclass(frozen=True, kw_only=True, eq=False)
class ResetOptions:
    """What a reset was asked for.

    Attributes
    ----------
    variant
        Sizes in mm, shape ``(env, parameter)``, or None to draw them.
    fixed
        Whether episodes begin at the fixed start of roll-outs.
    mask
        Environments to reset, shape ``(env,)``.
    """

    variant: FloatArray | None
    fixed: bool
    mask: BoolArray


def read_options(
    options: Mapping[str, Any] | None, obstacle: Obstacle, num_envs: int
) -> ResetOptions:
    """Read the options ``variant``, ``start`` and ``reset_mask``.

    Raises
    ------
    InputError
        If an option is unknown or does not fit.
    """
    given = dict(options or {})
    mask = _mask(given.pop("reset_mask", None), num_envs)
    variant = _variant(given.pop("variant", None), obstacle, num_envs)
    start = check_start(given.pop("start", "random"))
    if given:
        raise InputError(
            f"Reset does not know the option {', '.join(map(repr, given))}.",
            remedy="Options are variant, start ('random' or 'fixed') and reset_mask.",
        )
    return ResetOptions(variant=variant, fixed=start == "fixed", mask=mask)


def check_start(start: str) -> str:
    """Return where episodes begin.

    Raises
    ------
    InputError
        If it is neither ``"random"`` nor ``"fixed"``.
    """
    if start not in ("random", "fixed"):
        raise InputError(f"There is no start {start!r}.", remedy="Let it be 'random' or 'fixed'.")
    return start


def _variant(value: npt.ArrayLike | None, obstacle: Obstacle, num_envs: int) -> FloatArray | None:
    if value is None:
        return None
    given = np.asarray(value, dtype=np.float64)
    shape = (num_envs, 1)
    if given.shape == (num_envs,):
        given = given[:, None]
    if given.shape not in ((), shape):
        raise InputError(
            f"The variant has shape {given.shape}.",
            remedy=f"Give one size in mm, or an array of shape {shape[:1]} or {shape}.",
        )
    obstacle.check_sizes(given)
    return np.broadcast_to(given, shape)


def _mask(given: npt.ArrayLike | None, num_envs: int) -> BoolArray:
    mask = np.ones(num_envs, dtype=np.bool_) if given is None else np.asarray(given)
    if mask.shape != (num_envs,) or mask.dtype != np.bool_:
        raise InputError(
            f"The reset mask has shape {mask.shape} and type {mask.dtype}.",
            remedy=f"Give booleans of shape {(num_envs,)}.",
        )
    return mask
