"""Probabilities of choices: proportional to scores, beside a share that is uniform."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from surmount.core.arrays import FloatArray
from surmount.core.errors import ConfigError


def with_uniform_share(scores: FloatArray, share: float) -> FloatArray:
    """Return probabilities: ``share`` uniformly, the rest in proportion to non-negative scores.

    Where all scores are zero there is nothing to tell choices apart, and all is uniform.
    """
    uniform = np.full(scores.size, 1.0 / scores.size)
    total = float(scores.sum())
    return uniform if total <= 0 else share * uniform + (1.0 - share) * scores / total


def require_shares(config: Any, *names: str) -> None:
    """Refuse a configuration with a field of floating point outside (0, 1].

    Parameters
    ----------
    config
        The configuration.
    *names
        Fields to look at; all if there are none.

    Raises
    ------
    ConfigError
        Naming the field.
    """
    for field in dataclasses.fields(config):
        value = getattr(config, field.name)
        looked_at = not names or field.name in names
        if looked_at and isinstance(value, float) and not 0 < value <= 1:
            raise ConfigError(
                f"`{field.name}` is {value}.", remedy="Give a value above 0 and at most 1."
            )
