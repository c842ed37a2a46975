"""``surmount render``: a film or a sheet of moments of a policy, a manoeuvre or logged trials."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.showing import Shown
from surmount.core.errors import ConfigError
from surmount.core.printing import say


def render(
    shown: tyro.conf.OmitArgPrefixes[Shown],
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="FILE")],
    camera: Annotated[str, tyro.conf.arg(metavar="{track,side,front,top,course}")] = "track",
    size: Annotated[tuple[int, int], tyro.conf.arg(metavar="WIDTH HEIGHT")] = (640, 480),
    fps: Annotated[int | None, tyro.conf.arg(metavar="N")] = None,
    speed: Annotated[float | None, tyro.conf.arg(metavar="FACTOR")] = None,
    at: Annotated[tuple[float, ...], tyro.conf.arg(metavar="S ...")] = (),
) -> int:
    """Show the robot in a film (MP4, GIF) or on a sheet of moments (PNG); needs no display.

    A network on an environment of your own is drawn by that environment's own render; a PNG then
    holds the last moment of each episode.

    Args:
        shown: What to show.
        out: File to write; its suffix (.mp4, .gif, .png) says what it becomes.
        camera: track, side, front and top go along with the robot; course stands still.
        size: Width and height of a frame in pixels.
        fps: Frames per second of a film; 25 if left out.
        speed: Speed of a film against real time; 1 if left out, 0.25 is slow motion.
        at: Moments on a sheet, in s; six from start to end if left out.
    """
    from surmount.envs.video import FILM_WRITERS, PICTURE, check_output, write_png

    check_output(out)
    say(f"Drawing {shown.source} into {out}", file=sys.stderr)
    if _rendered_own(shown, out, fps):
        return 0
    # Only the robot's films need its simulation.
    from rich.progress import track

    from surmount.cli.motions import shown_motions
    from surmount.rstar.film.film import FilmConfig, contact_sheet, count_frames, frames
    from surmount.workflow.console import SafeConsole

    _refuse(at if out.suffix in FILM_WRITERS else (), "--at", "a film")
    _refuse((fps, speed) if out.suffix == PICTURE else (), "--fps and --speed", "a picture")
    film = FilmConfig(
        width_px=size[0],
        height_px=size[1],
        camera=camera,
        fps=25 if fps is None else fps,
        speed=1.0 if speed is None else speed,
    )
    motions = shown_motions(shown)
    if out.suffix == PICTURE:
        sheet = contact_sheet(motions, film, at)
        write_png(out, sheet)
        what = f"{sheet.shape[1]} x {sheet.shape[0]} pixels"
    else:
        count = count_frames(motions, film)
        console = SafeConsole(stderr=True)
        hidden = not sys.stderr.isatty()
        drawn = track(
            frames(motions, film), "drawing", count, console=console, disable=hidden, transient=True
        )
        FILM_WRITERS[out.suffix](out, drawn, film.fps)
        what = f"{count} frames, {count / film.fps:.1f} s, {size[0]} x {size[1]} pixels"
    say(f"Written to {out}: {what}")
    return 0


def _rendered_own(shown: Shown, out: Path, fps: int | None) -> bool:
    """Draw a network on anybody's environment by its own ``render``; return whether it is one."""
    import numpy as np

    from surmount.cli.options import environment_overrides
    from surmount.envs.video import FILM_WRITERS, GIF_FPS, write_png
    from surmount.experiment.evaluation import tasks_within
    from surmount.experiment.own_films import film_network, own_network

    found = own_network(
        Path(shown.source),
        task=shown.task,
        stage=shown.stage,
        network=shown.network or 0,
        changes=environment_overrides(shown.config, shown.set, whole_file=True),
    )
    if found is None:
        return False
    network, family, settings = found
    chosen = tasks_within(family.space(settings), shown.variant) if shown.variant else ()
    episodes = [
        *film_network(
            network,
            family,
            variants=list(chosen),
            seed=shown.seed or 0,
            deterministic=shown.deterministic,
            settings=settings,
        )
    ]
    frames = [frame for episode in episodes for frame in episode.frames]
    if out.suffix in FILM_WRITERS:
        rate = min(GIF_FPS, max(1, round(1 / episodes[0].step_s)))
        FILM_WRITERS[out.suffix](out, frames, fps or rate)
    else:
        write_png(out, np.concatenate([episode.frames[-1] for episode in episodes], axis=1))
    for episode in episodes:
        task = ", ".join(f"{name} {value}" for name, value in episode.task.items())
        say(f"{task}: {'succeeded' if episode.is_success else 'failed'}")
    say(f"Written to {out}: {len(frames)} frames by the environment's own render")
    return True


def _refuse(given: Iterable[object], options: str, what: str) -> None:
    """Raise if one of the options was given."""
    if any(value is not None for value in given):
        raise ConfigError(f"For {what}, {options} would do nothing.", remedy="Leave it out.")
