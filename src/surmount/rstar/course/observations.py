"""How a policy sees what is measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from surmount.core.arrays import FloatArray
from surmount.rstar.course.actions import ACTION_TERMS
from surmount.rstar.course.measures import MEASURES, TARGETS, Measures
from surmount.rstar.course.obstacles import Obstacle
from surmount.rstar.robot import constants as c

Observations = npt.NDArray[np.float32]

SIZE = "size_mm"
"""The one source of a term that is not a measure: the obstacle's size."""
_ROWS = (*MEASURES, *TARGETS)


@dataclass(frozen=True, kw_only=True)
class ObservationTerm:
    """One entry of the observation: ``(value − centre) / scale``, clipped to ± ``bound``.

    Attributes
    ----------
    name, symbol, unit, meaning
        What it is. S is the symbol of the paper's eq. 6, the others are this project's.
    source, sign
        The value is ``sign`` times this measure or target, or the obstacle's size.
    centre, scale, bound
        In the unit; the bound is a multiple of the scale.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    source: str
    sign: float = 1.0
    centre: float = 0.0
    scale: float
    bound: float = 2.0


def target_terms() -> tuple[ObservationTerm, ...]:
    """Return the entries of the servos' targets: what the policy's own actions have added up to."""
    return tuple(
        ObservationTerm(
            name=f"{term.name}_target",
            symbol=f"{term.symbol}*",
            unit=term.unit,
            meaning=f"target of the servos: {term.meaning}",
            source=source,
            centre=(term.upper + term.lower) / 2,
            scale=(term.upper - term.lower) / 2,
            bound=1.0,
        )
        for term, source in zip(ACTION_TERMS, TARGETS, strict=True)
    )


def observation_terms(obstacle: Obstacle, *, targets: bool = False) -> tuple[ObservationTerm, ...]:
    """Return the entries of the observation in order (paper III-B).

    Parameters
    ----------
    obstacle
        Family.
    targets
        Whether the servos' targets are observed, before the obstacle's size.
    """
    yaw = ObservationTerm(
        name="yaw",
        symbol="ψ",
        unit="deg",
        meaning="heading, left positive",
        source="yaw_deg",
        scale=90.0,
    )
    pitch = ObservationTerm(
        name="pitch",
        symbol="θ",
        unit="deg",
        meaning="tilt, nose up positive",
        source="pitch_deg",
        scale=90.0,
    )
    what = obstacle.parameter.removesuffix("_mm")
    return (
        yaw,
        *((pitch,) if obstacle.observes_pitch else ()),
        ObservationTerm(
            name="fbem",
            symbol="f",
            unit="deg",
            meaning="FBEM angle, measured; positive: body forward",
            source="fbem_deg",
            scale=c.FBEM_MAX_DEG,
        ),
        ObservationTerm(
            name="sprawl",
            symbol="s",
            unit="deg",
            meaning="sprawl angle, measured; 0 legs down, 90 flat",
            source="sprawl_deg",
            centre=90.0,
            scale=90.0,
        ),
        ObservationTerm(
            name="speed",
            symbol="S",
            unit="m/s",
            meaning="tangential speed: mean rim speed of the wheels",
            source="speed_mps",
            scale=c.SPEED_MAX_MPS,
        ),
        ObservationTerm(
            name="distance",
            symbol="d",
            unit="m",
            meaning="from the base to the obstacle's front face; negative beyond it",
            source="x_m",
            sign=-1.0,
            scale=0.3,
            bound=4.0,
        ),
        *(target_terms() if targets else ()),
        ObservationTerm(
            name="size",
            symbol=what[0],
            unit="mm",
            meaning=f"{what} of the obstacle",
            source=SIZE,
            centre=(obstacle.upper + obstacle.lower) / 2,
            scale=(obstacle.upper - obstacle.lower) / 2,
        ),
    )


class Observer:
    """Turns measures into observations.

    Parameters
    ----------
    terms
        Entries of the observation; the obstacle's size comes last.
    num_envs
        Number of environments.
    """

    def __init__(self, terms: tuple[ObservationTerm, ...], num_envs: int) -> None:
        def rows(values: list[float]) -> FloatArray:
            # One column per environment: NumPy takes twice as long where it has to repeat one.
            return np.repeat(np.array(values)[:, None], num_envs, axis=1)

        self._source = np.array([_ROWS.index(term.source) for term in terms[:-1]])
        # A sign in the scale gives the same bits as one on the value.
        self._scale = rows([term.sign * term.scale for term in terms])
        self._centre = rows([term.sign * term.centre for term in terms])
        self._sign = rows([term.sign for term in terms])
        self._upper = rows([term.bound for term in terms])
        self._lower = -self._upper
        self._values: FloatArray = np.empty((len(terms), num_envs))
        self._measured, self._size = self._values[:-1], self._values[-1]

    def observe(
        self, measures: Measures, size_mm: FloatArray, noise: FloatArray | None = None
    ) -> Observations:
        """Return observations within the terms' bounds.

        Parameters
        ----------
        measures
            What is measured.
        size_mm
            Size of each environment's obstacle, shape ``(env,)``.
        noise
            What to add to the terms' values, in their units, shape ``(term, env)``.

        Returns
        -------
        Observations
            Shape ``(env, term)``.
        """
        values = self._values
        measures.rows.take(self._source, axis=0, out=self._measured, mode="clip")
        self._size[:] = size_mm
        if noise is not None:
            values += self._sign * noise
        values -= self._centre
        values /= self._scale
        np.maximum(values, self._lower, out=values)
        np.minimum(values, self._upper, out=values)
        return values.T.astype(np.float32, order="C")
