"""Choosing the number of components by the Bayesian information criterion (paper eq. 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class BICCurve:
    """The BIC over the number of components, and the choice made on it (paper fig. 5).

    Attributes
    ----------
    components
        Numbers of components K tried, ascending.
    values
        BIC of each, of standardised features: differences mean the same in any units.
    converged
        Whether each fit converged.
    minimum
        K of the smallest BIC.
    chosen
        K taken: the smallest whose BIC is on the plateau.
    plateau
        Share of the curve's fall above its minimum that still counts as the plateau.
    """

    components: tuple[int, ...]
    values: tuple[float, ...]
    converged: tuple[bool, ...]
    minimum: int
    chosen: int
    plateau: float


def choose_components(
    components: Sequence[int],
    values: Sequence[float],
    converged: Sequence[bool],
    plateau: float,
) -> BICCurve:
    """Choose the smallest K whose BIC lies within ``plateau`` × the curve's fall of its minimum.

    The fall is the BIC of the first K minus the smallest BIC. With ``plateau = 0`` this is the
    minimum itself, as eq. 3 has it; a curve that hardly falls any more then still ends at the far
    end of the range, which buys components and no fit.
    """
    lowest = min(values)
    limit = lowest + plateau * max(0.0, values[0] - lowest)
    chosen = next(count for count, value in zip(components, values, strict=True) if value <= limit)
    return BICCurve(
        components=tuple(components),
        values=tuple(values),
        converged=tuple(converged),
        minimum=components[values.index(lowest)],
        chosen=chosen,
        plateau=plateau,
    )
