"""Motions as frames with captions: for a film, or side by side on one sheet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from surmount.envs.video import Frame
from surmount.rstar.course.rendering import FrameRenderer
from surmount.rstar.course.scene import CAMERA, CAMERAS, COURSE_CAMERA
from surmount.rstar.film.motion import Motion, Puppet
from surmount.rstar.robot.config import require_choice, require_range

LINES_PER_FRAME = 24
"""Lines of caption that would fill a frame."""
MOMENTS, COLUMNS = 6, 3
"""Moments of a motion on a sheet, and pictures in a row."""
INK, PAPER = (20, 28, 38), (255, 255, 255, 190)


@dataclass(frozen=True, kw_only=True)
class FilmConfig:
    """How a motion is shown."""

    fps: int = 25
    """Frames per second of the film."""
    width_px: int = 640
    """Width of a frame in pixels."""
    height_px: int = 480
    """Height of a frame in pixels."""
    camera: str = CAMERA
    """Camera: "track", "side", "front" or "top" go along with the robot, "course" stands still."""
    speed: float = 1.0
    """Speed of the film against real time: below 1 is slow motion."""
    hold_s: float = 1.0
    """Time in s of the film that the last moment stays in view."""

    def __post_init__(self) -> None:
        require_range("fps", self.fps, 1, 240)
        require_range("width", self.width_px, 32, 4096)
        require_range("height", self.height_px, 32, 4096)
        require_choice("camera", self.camera, (*CAMERAS, COURSE_CAMERA))
        require_range("speed", self.speed, 0.001, 1000.0)
        require_range("hold", self.hold_s, 0.0, 60.0)

    @property
    def size(self) -> tuple[int, int]:
        """Height and width of a frame in pixels."""
        return self.height_px, self.width_px


def moving_frames(motion: Motion, config: FilmConfig) -> int:
    """Return the number of frames from start to end, both included."""
    return math.ceil(motion.duration_s * config.fps / config.speed - 1e-6) + 1


def count_frames(motions: Sequence[Motion], config: FilmConfig) -> int:
    """Return the number of frames of :func:`frames`."""
    held = round(config.hold_s * config.fps)
    return sum(moving_frames(motion, config) + held for motion in motions)


def frames(motions: Sequence[Motion], config: FilmConfig) -> Iterator[Frame]:
    """Yield the frames of a film: motions on one course, one after the other."""
    with _Camera(motions[0], config) as camera:
        for motion in motions:
            camera.follow(motion)
            frame = camera.picture(0.0)
            for index in range(1, moving_frames(motion, config)):
                yield frame
                time_s = min(index * config.speed / config.fps, motion.duration_s)
                frame = camera.picture(time_s)
            for _ in range(1 + round(config.hold_s * config.fps)):
                yield frame


def contact_sheet(
    motions: Sequence[Motion], config: FilmConfig, times_s: Sequence[float] = ()
) -> Frame:
    """Return moments of motions on one picture, in rows of :data:`COLUMNS`.

    Parameters
    ----------
    motions
        On one course, in the order of reading.
    config
        Size of each picture, and camera.
    times_s
        Moments of each motion in s; a motion that has ended shows its end. If none are given,
        :data:`MOMENTS` from start to end.

    Raises
    ------
    ConfigError
        If a moment is negative.
    """
    for time_s in times_s:
        require_range("at", time_s, 0.0, float("inf"))
    pictures: list[Frame] = []
    with _Camera(motions[0], config) as camera:
        for motion in motions:
            camera.follow(motion)
            moments = times_s or np.linspace(0.0, motion.duration_s, MOMENTS).tolist()
            pictures += [camera.picture(min(time_s, motion.duration_s)) for time_s in moments]
    columns = min(COLUMNS, len(pictures))
    blank = np.full((*config.size, 3), 255, dtype=np.uint8)
    pictures += [blank] * (-len(pictures) % columns)
    rows = [np.hstack(pictures[i : i + columns]) for i in range(0, len(pictures), columns)]
    return np.vstack(rows)


class _Camera:
    """Takes pictures of motions on one course."""

    def __init__(self, motion: Motion, config: FilmConfig) -> None:
        self._motion = motion
        self._config = config
        self._puppet = Puppet(motion)
        buffer = self._puppet.model.vis.global_
        buffer.offheight = max(buffer.offheight, config.height_px)
        buffer.offwidth = max(buffer.offwidth, config.width_px)
        self._renderer = FrameRenderer(self._puppet.model, config.size)

    def __enter__(self) -> _Camera:
        return self

    def __exit__(self, *_: object) -> None:
        self._renderer.close()

    def follow(self, motion: Motion) -> None:
        self._motion = motion
        self._puppet.follow(motion)

    def picture(self, time_s: float) -> Frame:
        motion = self._motion
        frame = self._renderer.frame(self._puppet.at(time_s), self._config.camera)
        lines = [f"{motion.obstacle.name}, {motion.size_mm:g} mm", motion.caption]
        if time_s >= motion.duration_s - 1e-9:
            lines.append(motion.outcome)
        clock = f"{time_s:.2f} s"
        if self._config.speed != 1.0:
            clock += f"   speed x {self._config.speed:g}"
        return _captioned(frame, lines, clock)


def _captioned(frame: Frame, lines: Sequence[str], corner: str) -> Frame:
    """Return a frame with lines of text at its top, and one in its right upper corner."""
    image = Image.fromarray(frame)
    draw = ImageDraw.Draw(image, "RGBA")
    line_px = max(image.height / LINES_PER_FRAME, 9.0)
    margin = line_px / 3
    font = ImageFont.load_default(line_px * 0.75)
    draw.rectangle((0, 0, image.width, margin * 1.5 + line_px * len(lines)), fill=PAPER)
    for index, line in enumerate(lines):
        draw.text((margin, margin + index * line_px), line, fill=INK, font=font)
    draw.text((image.width - margin, margin), corner, fill=INK, font=font, anchor="ra")
    return np.asarray(image)
