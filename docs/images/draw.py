"""Draw the README's pictures of the robot: ``python docs/images/draw.py [folder]``."""

from __future__ import annotations

import sys
from itertools import islice
from pathlib import Path

import numpy as np

from surmount.envs.video import write_gif, write_png
from surmount.rstar.film.film import FilmConfig, contact_sheet, count_frames, frames
from surmount.rstar.film.footage import Wanted, motions

STILLS = (
    ("narrow-channel", "front", 0.70),
    ("low-entrance", "track", 0.75),
    ("step", "track", 0.8),
)
"""Obstacle, camera, and moment as a fraction of the stored manoeuvre for its hardest variant."""

NETWORKS = Path(__file__).parents[1] / "results/reproduction/narrow-channel-2032/networks"
ARMS = ("control-2", "curriculum-2")
"""The network of that run whose arms differ most, without and with the curriculum."""
ARMS_MM, ARMS_SEED, ARMS_HOLD_S, ARMS_FPS = 190.0, 0, 1.0, 12
"""The width on which they differ most; the seed of both policies' draws."""


def draw(folder: Path) -> None:
    """Write ``obstacles.png``, ``step.gif`` and ``arms.gif``."""
    stills = {}
    for obstacle, camera, moment in STILLS:
        (motion,) = motions(Wanted(source=obstacle))
        film = FilmConfig(camera=camera, width_px=640, height_px=420)
        stills[obstacle] = contact_sheet([motion], film, [moment * motion.duration_s])
    write_png(folder / "obstacles.png", np.hstack(list(stills.values())))
    film = FilmConfig(camera="course", width_px=480, height_px=320, fps=20)
    climb = list(motions(Wanted(source="step")))
    write_gif(folder / "step.gif", frames(climb, film), film.fps)
    draw_arms(folder)


def draw_arms(folder: Path) -> None:
    """Write ``arms.gif``: both arms side by side until the one with the curriculum has arrived."""
    film = FilmConfig(camera="front", width_px=400, height_px=270, fps=ARMS_FPS, hold_s=ARMS_HOLD_S)
    without, with_curriculum = (
        list(
            motions(
                Wanted(
                    source=str(NETWORKS / f"{arm}.safetensors"),
                    sizes_mm=(ARMS_MM,),
                    seed=ARMS_SEED,
                )
            )
        )
        for arm in ARMS
    )
    shown = islice(
        zip(frames(without, film), frames(with_curriculum, film), strict=False),
        count_frames(with_curriculum, film),
    )
    write_gif(folder / "arms.gif", (np.hstack(pair) for pair in shown), film.fps)


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
