"""Films show the robot, the obstacle and the moments that they say."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from graphics import blue, needs_graphics, orange

from surmount.core.errors import ConfigError
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import find_obstacle
from surmount.rstar.course.rendering import FrameRenderer
from surmount.rstar.course.scene import CAMERAS, COURSE_CAMERA
from surmount.rstar.film.film import (
    COLUMNS,
    MOMENTS,
    FilmConfig,
    contact_sheet,
    count_frames,
    frames,
    moving_frames,
)
from surmount.rstar.film.motion import Puppet, record_motion

SMALL = {"width_px": 96, "height_px": 72}
STEP = find_obstacle("step")
CONFIG = EnvConfig(step_s=0.1)


def drive(observations, x_m):
    return np.array([[1.0, 0.0, 0.0]])


def motion_of(size_mm=50.0, obstacle=STEP, longest_s=0.6):
    return record_motion(obstacle, CONFIG, size_mm, drive, caption="drive", longest_s=longest_s)


def test_a_film_lasts_as_long_as_its_motions_at_their_speed():
    motion = motion_of()
    assert moving_frames(motion, FilmConfig(fps=10)) == 7  # 0.0, 0.1, … 0.6 s
    assert moving_frames(motion, FilmConfig(fps=25, speed=0.25)) == 61
    assert moving_frames(motion, FilmConfig(fps=7, speed=1.0)) == 6  # 0.0, 0.143, … 0.6 s
    assert count_frames([motion, motion], FilmConfig(fps=10, hold_s=0.5)) == 2 * (7 + 5)


@needs_graphics
def test_a_film_has_the_frames_it_announces_and_ends_with_the_outcome():
    film = FilmConfig(fps=5, hold_s=0.4, **SMALL)
    shown = list(frames([motion_of()], film))
    assert len(shown) == count_frames([motion_of()], film) == 4 + 2
    assert {frame.shape for frame in shown} == {(72, 96, 3)}
    assert all(orange(frame) > 10 for frame in shown)
    moved = [np.abs(a.astype(int) - b).mean() for a, b in pairwise(shown)]
    assert moved[:3] > [0.1] * 3
    assert moved[3:] == [0.0] * 2  # held
    # Two lines of caption, and a third with the outcome at the end, on bright paper.
    third_line = [frame[24:30].mean() for frame in shown]
    assert min(third_line[3:]) > max(third_line[:3]) + 20


@needs_graphics
def test_the_variant_is_what_is_shown():
    film = FilmConfig(camera="course", width_px=192, height_px=144)
    sizes = [21.0, 35.0, 50.0]
    sheet = contact_sheet([motion_of(size, longest_s=0.1) for size in sizes], film, [0.0])
    seen = [blue(picture) for picture in np.hsplit(sheet, 3)]
    assert seen[1] > 1.04 * seen[0] > 1000  # the top is as large, the faces are higher
    assert seen[2] > 1.04 * seen[1]


@needs_graphics
@pytest.mark.parametrize("name", ["narrow-channel", "low-entrance", "step"])
def test_every_camera_shows_the_robot_on_every_course(name):
    obstacle = find_obstacle(name)
    motion = motion_of(obstacle.upper, obstacle, longest_s=0.2)
    puppet = Puppet(motion)
    renderer = FrameRenderer(puppet.model, (144, 192))
    for camera in (*CAMERAS, COURSE_CAMERA):
        assert orange(renderer.frame(puppet.at(0.1), camera)) > 30, camera
    renderer.close()


@needs_graphics
def test_a_sheet_has_its_moments_in_rows():
    motion = motion_of()
    sheet = contact_sheet([motion], FilmConfig(**SMALL))
    assert sheet.shape == (72 * MOMENTS // COLUMNS, 96 * COLUMNS, 3)
    two = contact_sheet([motion, motion_of(21.0)], FilmConfig(**SMALL), [0.3])
    assert two.shape == (72, 2 * 96, 3)
    four = contact_sheet([motion, motion], FilmConfig(**SMALL), [0.0, 9.0])
    assert four.shape == (2 * 72, 3 * 96, 3)
    assert (four[72:, 96:] == 255).all()  # nothing left to show
    np.testing.assert_array_equal(four[:72, :96], four[:72, 2 * 96 :])


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"fps": 0}, "`fps` is 0"),
        ({"width_px": 7}, "`width` is 7"),
        ({"speed": 0.0}, "`speed` is 0.0"),
        ({"camera": "drone"}, "`camera` is 'drone'"),
        ({"hold_s": float("nan")}, "`hold` is nan"),
    ],
)
def test_what_cannot_be_filmed_is_refused(options, sentence):
    with pytest.raises(ConfigError, match=sentence):
        FilmConfig(**options)


def test_moments_before_the_start_are_refused():
    with pytest.raises(ConfigError, match="`at` is -1"):
        contact_sheet([motion_of()], FilmConfig(), [-1.0])
