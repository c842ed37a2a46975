"""Frames into a file: MP4 by PyAV, whose wheel brings FFmpeg along, GIF and PNG by Pillow."""

from __future__ import annotations

import contextlib
import secrets
from collections.abc import Callable, Generator, Iterable, Mapping
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType

import av
import numpy as np
import numpy.typing as npt
from PIL import Image

from surmount.core.errors import ConfigError, InputError, OutputError
from surmount.workflow.store import output_errors

Frame = npt.NDArray[np.uint8]
"""A picture, shape ``(height, width, 3)``."""

QUALITY = "20"
"""H.264's constant rate factor: 18 is hardly to be told from the original, 28 is coarse."""
GIF_COLOURS = 128
GIF_FPS = 50
"""Viewers show a frame of a GIF for 0.02 s at the least, and faster ones far too slowly."""


def write_mp4(path: Path, frames: Iterable[Frame], fps: int) -> int:
    """Write frames as H.264 in MP4, whole or not at all, and return their number.

    Parameters
    ----------
    path
        File to write.
    frames
        Pictures of one size, of even width and height, shape ``(height, width, 3)``.
    fps
        Frames per second.

    Raises
    ------
    ConfigError
        If width or height is odd.
    InputError
        If there are no frames.
    OutputError
        If the file cannot be written.
    """
    count = 0
    with _appearing(path) as temporary, av.open(str(temporary), "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=fps)
        stream.pix_fmt = "yuv420p"  # what every player shows
        stream.options = {"crf": QUALITY, "preset": "medium"}
        for frame in frames:
            if count == 0:
                stream.height, stream.width = _even(frame)
            picture = av.VideoFrame.from_ndarray(np.ascontiguousarray(frame), format="rgb24")
            picture.pts, picture.time_base = count, Fraction(1, fps)
            container.mux(stream.encode(picture))
            count += 1
        if count == 0:
            raise _no_frames(path)
        container.mux(stream.encode())
    return count


def write_gif(path: Path, frames: Iterable[Frame], fps: int) -> int:
    """Write frames as a GIF that repeats, whole or not at all, and return their number.

    All frames share the colours of the first. Frames equal to the one before become one that stays
    longer. Parameters and errors are those of :func:`write_mp4`; sizes may be odd.
    """
    if fps > GIF_FPS:
        raise ConfigError(
            f"{fps} frames per second are too many for a GIF.",
            remedy=f"Give at most {GIF_FPS}, or write an MP4.",
        )
    pictures: list[Image.Image] = []
    for frame in frames:
        image = Image.fromarray(frame)
        if pictures:
            pictures.append(image.quantize(palette=pictures[0], dither=Image.Dither.NONE))
        else:
            pictures.append(image.quantize(GIF_COLOURS, dither=Image.Dither.NONE))
    if not pictures:
        raise _no_frames(path)
    # Times of a GIF are hundredths of a second: round the moments, not the durations.
    moments = np.round(np.arange(len(pictures) + 1) * 100 / fps) * 10
    with _appearing(path) as temporary:
        pictures[0].save(
            temporary,
            format="GIF",
            save_all=True,
            append_images=pictures[1:],
            duration=np.diff(moments).astype(int).tolist(),
            loop=0,
        )
    return len(pictures)


def write_png(path: Path, frame: Frame) -> None:
    """Write one picture, whole or not at all."""
    with _appearing(path) as temporary:
        Image.fromarray(frame).save(temporary, format="PNG", optimize=True)


FilmWriter = Callable[[Path, Iterable[Frame], int], int]
FILM_WRITERS: Mapping[str, FilmWriter] = MappingProxyType({".mp4": write_mp4, ".gif": write_gif})
"""What writes films, by the suffix of their files."""
PICTURE = ".png"


def check_output(path: Path) -> None:
    """Refuse a file of an unknown kind or one that cannot be written, before anything is drawn.

    Raises
    ------
    ConfigError
        If the suffix names no kind of file that can be written.
    OutputError
        If the file cannot be written.
    """
    kinds = (*FILM_WRITERS, PICTURE)
    if path.suffix not in kinds:
        raise ConfigError(
            f"{path} ends in none of {', '.join(kinds)}.",
            remedy="Give a file that ends in .mp4 or .gif for a film, or .png for a sheet of "
            "moments.",
        )
    with _appearing(path, publish=False) as temporary:
        temporary.touch()


@contextlib.contextmanager
def _appearing(path: Path, *, publish: bool = True) -> Generator[Path]:
    """Give a file to write to that takes its place when it is complete."""
    if path.is_dir():
        raise OutputError(f"{path} is a folder.", remedy="Give the name of a file.")
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    with output_errors(path.parent):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield temporary
            if publish:
                temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)


def _even(frame: Frame) -> tuple[int, int]:
    height, width = frame.shape[:2]
    if height % 2 or width % 2:
        raise ConfigError(
            f"An MP4 cannot be {width} x {height} pixels.",
            remedy="Give an even width and an even height.",
        )
    return height, width


def _no_frames(path: Path) -> InputError:
    return InputError(f"There are no frames to write to {path}.", remedy="Show a longer motion.")
