"""Seeds derived from one root seed and a path of names.

Two stages never share a stream, and adding a stage does not change the seeds of the others,
because a seed depends on the *name* of what it is for and not on the order of the calls.
"""

from __future__ import annotations

import hashlib

import numpy as np

SEED_BITS = 31
"""Derived seeds are non-negative and fit a signed 32-bit integer, which every library accepts."""


def derive_seed(root: int, *path: str | int) -> int:
    """Derive an independent seed for a named purpose.

    Parameters
    ----------
    root
        The user's seed.
    path
        Names from coarse to fine, for example ``"rollouts", "network-0"``.

    Returns
    -------
    int
        A seed in ``[0, 2**31)``, the same on every machine.
    """
    text = "\x1f".join([str(root), *(f"{type(part).__name__}:{part}" for part in path)])
    digest = hashlib.sha256(text.encode()).digest()
    return int.from_bytes(digest[:8], "big") >> (64 - SEED_BITS)


def generator(root: int, *path: str | int) -> np.random.Generator:
    """Return a NumPy generator seeded by :func:`derive_seed`."""
    return np.random.default_rng(derive_seed(root, *path))
