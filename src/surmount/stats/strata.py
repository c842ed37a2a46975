"""Scores by network and variant, in strata with networks of their own, and redrawing them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import FloatArray, IntArray
from surmount.core.errors import InputError
from surmount.stats.columns import numbers

Scores = npt.ArrayLike | Mapping[str, npt.ArrayLike]
"""Scores of shape ``(network, variant)`` or ``(network,)``, or one such array per stratum."""


def read_strata(scores: Scores, name: str) -> dict[str, FloatArray]:
    """Return one matrix ``(network, variant)`` per stratum."""
    named = scores if isinstance(scores, Mapping) else {name: scores}
    if not named:
        raise InputError(f"`{name}` holds no stratum.", remedy="Give at least one.")
    strata: dict[str, FloatArray] = {}
    for key, values in named.items():
        try:
            matrix = np.asarray(values)
        except ValueError as error:
            raise InputError(
                f"The scores of `{key}` have rows of different length.",
                remedy="Give one row per network and one column per variant.",
            ) from error
        if matrix.ndim not in (1, 2):
            raise InputError(
                f"The scores of `{key}` have shape {matrix.shape}.",
                remedy="Give one row per network and one column per variant.",
            )
        strata[str(key)] = numbers(matrix.ravel(), str(key)).reshape(matrix.shape[0], -1)
    return strata


def sizes(*arms: Mapping[str, FloatArray]) -> tuple[int, ...]:
    """Return the number of networks in each stratum, arm after arm."""
    return tuple(matrix.shape[0] for arm in arms for matrix in arm.values())


def too_few(*arms: Mapping[str, FloatArray]) -> str | None:
    """Return why nothing can be redrawn, or ``None`` if every stratum has two networks."""
    single = [key for arm in arms for key, matrix in arm.items() if matrix.shape[0] < 2]
    if not single:
        return None
    return (
        f"There are fewer than two networks in `{single[0]}`, so nothing is known of how the "
        "estimate would change with another."
    )


def drawn(strata: Mapping[str, FloatArray], rng: np.random.Generator) -> dict[str, IntArray]:
    """Draw as many networks as there are from each stratum, with replacement."""
    return {key: rng.integers(0, len(matrix), len(matrix)) for key, matrix in strata.items()}


def flat(strata: Mapping[str, FloatArray], rows: Mapping[str, IntArray] | None) -> FloatArray:
    """Return all scores, or those of the networks drawn, as one array of shape ``(score,)``."""
    parts = [matrix if rows is None else matrix[rows[key]] for key, matrix in strata.items()]
    return np.concatenate([part.ravel() for part in parts])


def read_two_arms(
    first: Scores, second: Scores, *, paired: bool
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Return the matrices of two arms by stratum, checked to have the same variants.

    ``paired`` arms are checked to have the same number of networks in each stratum, too.
    """
    one, two = read_strata(first, "first"), read_strata(second, "second")
    if isinstance(first, Mapping) != isinstance(second, Mapping):
        raise InputError(
            "One arm is divided into strata and the other is not.",
            remedy="Divide both arms alike.",
        )
    if not isinstance(first, Mapping):
        two = {"first": two["second"]}
    if set(one) != set(two):
        raise InputError(
            f"The arms have different strata: {sorted(one)} and {sorted(two)}.",
            remedy="Give both arms the same strata.",
        )
    for key, matrix in one.items():
        if matrix.shape[1] != two[key].shape[1]:
            raise InputError(
                f"The arms have {matrix.shape[1]} and {two[key].shape[1]} variants.",
                remedy="Test both arms on the same variants, in the same order.",
            )
        if paired and len(matrix) != len(two[key]):
            raise InputError(
                f"Pairs need as many networks in both arms, not {len(matrix)} and {len(two[key])}.",
                remedy="Give row i of both arms the same initial network, or set paired=False.",
            )
    return one, {key: two[key] for key in one}
