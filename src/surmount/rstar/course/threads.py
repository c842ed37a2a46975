"""How many threads share the physics."""

from __future__ import annotations

import os

from surmount.core.errors import ConfigError

ENVS_PER_THREAD = 4
"""Environments that a further thread needs to be worth its while (ADR 41)."""


def choose_threads(n_threads: int | None, num_envs: int) -> int:
    """Return the number of threads for so many environments.

    Parameters
    ----------
    n_threads
        What was asked for; None for one per :data:`ENVS_PER_THREAD` environments, at most as many
        as this process may use processors.
    num_envs
        Number of environments.

    Raises
    ------
    ConfigError
        If fewer than one was asked for.
    """
    if n_threads is None:
        return max(1, min(_processors(), num_envs // ENVS_PER_THREAD))
    if n_threads < 1:
        raise ConfigError(f"`n_threads` is {n_threads}.", remedy="Give 1 or more, or None.")
    return min(n_threads, num_envs)


def _processors() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
