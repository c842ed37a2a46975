"""Draw the README's pictures of the robot: ``python docs/images/draw.py [folder]``."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from surmount.envs.video import write_gif, write_png
from surmount.rstar.film.film import FilmConfig, contact_sheet, frames
from surmount.rstar.film.footage import Wanted, motions

STILLS = (
    ("narrow-channel", "front", 0.70),
    ("low-entrance", "track", 0.75),
    ("step", "track", 0.8),
)
"""Obstacle, camera, and moment as a fraction of the stored manoeuvre for its hardest variant."""


def draw(folder: Path) -> None:
    """Write ``obstacles.png`` and ``step.gif``."""
    stills = {}
    for obstacle, camera, moment in STILLS:
        (motion,) = motions(Wanted(source=obstacle))
        film = FilmConfig(camera=camera, width_px=640, height_px=420)
        stills[obstacle] = contact_sheet([motion], film, [moment * motion.duration_s])
    write_png(folder / "obstacles.png", np.hstack(list(stills.values())))
    film = FilmConfig(camera="course", width_px=480, height_px=320, fps=20)
    climb = list(motions(Wanted(source="step")))
    write_gif(folder / "step.gif", frames(climb, film), film.fps)


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
