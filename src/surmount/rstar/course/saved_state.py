"""States of environments as they are saved, and whether one fits an environment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from surmount.core.errors import InputError

SCHEMA = 2
"""Version of what ``state_dict`` returns."""


def check_state(saved: Mapping[str, Any], present: Mapping[str, Any]) -> None:
    """Raise :class:`InputError` unless a saved state fits an environment.

    Parameters
    ----------
    saved
        State to load.
    present
        State of the environment that is to load it.
    """
    found, expected = _layout(saved), _layout(present)
    if found != expected:
        name = next(name for name in [*expected, *found] if found.get(name) != expected.get(name))
        raise InputError(
            f"The environment state's `{name}` is {found.get(name, 'missing')}, expected "
            f"{expected.get(name, 'nothing')}.",
            remedy="Load a state saved by an environment made with the same arguments.",
        )


def _layout(state: Mapping[str, Any]) -> dict[str, str]:
    """Return what must be equal: version, obstacle, names and shapes."""
    layout = {
        name: f"of shape {value.shape}" if isinstance(value, np.ndarray) else "present"
        for name, value in state.items()
    }
    return layout | {name: repr(state.get(name)) for name in ("schema", "obstacle")}
