"""Manoeuvres made by hand, which a search tries before it draws any.

What the most capable trained networks did on the highest steps, in a few numbers: drive on with the
legs down, and once the front wheels are on the edge hold the body forward over them or rock it,
until the carriers have slid over.
"""

from __future__ import annotations

import itertools

from surmount.rstar.manoeuvres.manoeuvre import Manoeuvre, Phase

ROCKS = 16
"""Times the body is rocked before it is held back for good."""
ON_THE_EDGE_M = -0.09
"""Position of the base at which the front wheels have climbed, from the front face, in m."""
OVER_M = 0.15
"""Position of the base at which the carriers have slid over, in m."""


def templates() -> tuple[Manoeuvre, ...]:
    """Return the manoeuvres: 72 combinations of approach, sprawl, speed and rocking."""
    approaches = itertools.product((0.0, 10.0, 25.0), (0.0, 10.0), (0.25, 0.15))
    made: list[Manoeuvre] = []
    for fbem, sprawl, speed in approaches:
        approach = _phase(speed, fbem, sprawl, until_x_m=ON_THE_EDGE_M, at_most_s=3.0)
        made += [
            Manoeuvre(phases=(approach, _phase(0.25, forward, 0.0, until_x_m=9.0, at_most_s=20.0)))
            for forward in (50.0, 60.0, 72.0)
        ]
        for back, forward, time_s in ((50.0, 72.0, 0.3), (45.0, 72.0, 0.4), (55.0, 70.0, 0.2)):
            rock = tuple(
                _phase(0.25, angle, 0.0, until_x_m=OVER_M, at_most_s=time_s)
                for angle in (forward, back)
            )
            made.append(Manoeuvre(phases=(approach, *rock * ROCKS)))
    return tuple(made)


def _phase(
    speed_mps: float, fbem_deg: float, sprawl_deg: float, *, until_x_m: float, at_most_s: float
) -> Phase:
    return Phase(
        speed_mps=speed_mps,
        fbem_deg=fbem_deg,
        sprawl_deg=sprawl_deg,
        until_x_m=until_x_m,
        at_most_s=at_most_s,
    )
