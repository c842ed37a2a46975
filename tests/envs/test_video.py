"""Files hold the frames that were written to them, or are not there."""

from __future__ import annotations

import os

import av
import numpy as np
import pytest
from PIL import Image

from surmount.core.errors import ConfigError, InputError, OutputError
from surmount.envs.video import check_output, write_gif, write_mp4, write_png


def moving_square(count, height=48, width=64):
    """Yield frames in which an orange square wanders over blue."""
    for index in range(count):
        frame = np.empty((height, width, 3), dtype=np.uint8)
        frame[:] = 60, 110, 160
        frame[16:32, index : index + 16] = 240, 120, 30
        yield frame


@pytest.mark.parametrize("fps", [10, 24])
def test_an_mp4_decodes_to_its_frames_at_their_times(tmp_path, fps):
    path = tmp_path / "film.mp4"
    assert write_mp4(path, moving_square(30), fps) == 30
    with av.open(path) as film:
        stream = film.streams.video[0]
        decoded = list(film.decode(video=0))
        assert stream.average_rate == fps
        assert stream.codec_context.name == "h264"
        assert (stream.width, stream.height, stream.pix_fmt) == (64, 48, "yuv420p")
    assert [frame.time for frame in decoded] == pytest.approx(np.arange(30) / fps)
    for found, written in zip(decoded, moving_square(30), strict=True):
        error = np.abs(found.to_ndarray(format="rgb24").astype(int) - written)
        assert error.mean() < 8  # colours are stored at half resolution: edges blur
    assert [path.name for path in tmp_path.iterdir()] == ["film.mp4"]


@pytest.mark.parametrize("fps", [10, 30])
def test_a_gif_shows_its_frames_for_as_long_as_asked(tmp_path, fps):
    path = tmp_path / "film.gif"
    assert write_gif(path, moving_square(30), fps) == 30
    with Image.open(path) as film:
        assert (film.n_frames, film.size, film.info["loop"]) == (30, (64, 48), 0)
        shown_ms = []
        for index, written in enumerate(moving_square(30)):
            film.seek(index)
            shown_ms.append(film.info["duration"])
            error = np.abs(np.asarray(film.convert("RGB")).astype(int) - written)
            assert error.max() < 8  # two colours fit its palette, nearly
    assert sum(shown_ms) == 30 * 1000 / fps
    assert np.ptp(shown_ms) <= 10  # a GIF's times are hundredths of a second


def test_frames_that_stay_the_same_make_a_gif_as_long(tmp_path):
    path = tmp_path / "film.gif"
    still = [*moving_square(3)] + [*moving_square(3)][-1:] * 7
    assert write_gif(path, still, 10) == 10
    with Image.open(path) as film:
        total_ms = 0
        for index in range(film.n_frames):
            film.seek(index)
            total_ms += film.info["duration"]
    assert total_ms == 1000


def test_a_png_holds_its_frame(tmp_path):
    (frame,) = moving_square(1)
    write_png(tmp_path / "new" / "sheet.png", frame)
    with Image.open(tmp_path / "new" / "sheet.png") as sheet:
        np.testing.assert_array_equal(np.asarray(sheet), frame)


@pytest.mark.parametrize("writer", [write_mp4, write_gif])
def test_no_frames_are_no_film(tmp_path, writer):
    with pytest.raises(InputError, match="no frames"):
        writer(tmp_path / "film", [], 10)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("writer", [write_mp4, write_gif])
def test_a_film_that_fails_half_way_leaves_the_old_file(tmp_path, writer):
    path = tmp_path / "film"
    path.write_text("old", encoding="utf-8")

    def failing():
        yield from moving_square(3)
        raise RuntimeError("half way")

    with pytest.raises(RuntimeError, match="half way"):
        writer(path, failing(), 10)
    assert [path.read_text(encoding="utf-8") for path in tmp_path.iterdir()] == ["old"]


def test_sizes_and_rates_that_a_format_cannot_hold_are_refused(tmp_path):
    with pytest.raises(ConfigError, match="63 x 48 pixels"):
        write_mp4(tmp_path / "film.mp4", moving_square(2, width=63), 10)
    with pytest.raises(ConfigError, match="60 frames per second"):
        write_gif(tmp_path / "film.gif", moving_square(2), 60)
    assert not list(tmp_path.iterdir())


def test_files_that_cannot_be_written_are_refused_beforehand(tmp_path):
    with pytest.raises(ConfigError, match=r"none of \.mp4, \.gif, \.png"):
        check_output(tmp_path / "film.avi")
    (tmp_path / "folder.gif").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        check_output(tmp_path / "folder.gif")
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="is not a folder"):
        check_output(tmp_path / "file" / "film.mp4")
    check_output(tmp_path / "film.mp4")
    assert {path.name for path in tmp_path.iterdir()} == {"folder.gif", "file"}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission_is_refused(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError, match="may not be written"):
        check_output(tmp_path / "film.mp4")
