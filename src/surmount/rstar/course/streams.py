"""One random stream per environment, so that none depends on how many there are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surmount.core.errors import InputError


class Streams(Sequence[np.random.Generator]):
    """The environments' generators; unseeded at first.

    Parameters
    ----------
    num_envs
        Number of environments.
    """

    def __init__(self, num_envs: int) -> None:
        self._generators = _spawn(np.random.SeedSequence(), num_envs)

    def __len__(self) -> int:
        return len(self._generators)

    def __getitem__(self, env: Any) -> Any:
        return self._generators[env]

    def seed(self, seed: int | Sequence[int | None]) -> None:
        """Begin the streams anew.

        Parameters
        ----------
        seed
            An integer gives environment ``i`` the ``i``-th child of its seed sequence; a sequence
            gives each environment the first child of its own seed, or leaves it as it is (None).
        """
        if not isinstance(seed, Sequence):
            self._generators = _spawn(np.random.SeedSequence(int(seed)), len(self))
            return
        if len(seed) != len(self):
            raise InputError(
                f"{len(seed)} seeds were given for {len(self)} environments.",
                remedy="Give one seed per environment, or a single integer.",
            )
        for env, value in enumerate(seed):
            if value is not None:
                self._generators[env] = _spawn(np.random.SeedSequence(value), 1)[0]

    def state(self) -> list[Mapping[str, Any]]:
        """Return the generators' states, fit for JSON."""
        return [generator.bit_generator.state for generator in self._generators]

    def load_state(self, state: Sequence[Mapping[str, Any]]) -> None:
        """Go on from :meth:`state`."""
        for generator, saved in zip(self._generators, state, strict=True):
            generator.bit_generator.state = saved


def _spawn(sequence: np.random.SeedSequence, count: int) -> list[np.random.Generator]:
    return [np.random.Generator(np.random.PCG64(child)) for child in sequence.spawn(count)]
