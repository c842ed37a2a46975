"""Playback runs in real time, pauses, steps, and begins again."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.core.errors import SurmountError
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import find_obstacle
from surmount.rstar.film import playback
from surmount.rstar.film.motion import record_motion, stand_still
from surmount.rstar.film.playback import HOLD_S, LEFT, RIGHT, SPACE, STEP_S, Transport, play

STEP = find_obstacle("step")
MOTIONS = [
    record_motion(STEP, EnvConfig(), size, stand_still, caption="standing", longest_s=longest_s)
    for size, longest_s in ((21.0, 1.0), (50.0, 0.5))
]


def test_motions_follow_one_another_and_begin_again():
    transport = Transport(MOTIONS, speed=0.5)
    transport.advance(1.0)
    assert (transport.motion, transport.time_s) == (MOTIONS[0], pytest.approx(0.5))
    assert "end" not in transport.caption[0]
    transport.advance(1.0 + HOLD_S - 0.01)
    assert (transport.motion, transport.time_s) == (MOTIONS[0], 1.0)  # its end, for a while
    assert transport.caption[1].endswith("shown for 1.00 s")
    transport.advance(0.02)
    assert (transport.motion, transport.time_s) == (MOTIONS[1], 0.0)
    transport.advance(1.0 + HOLD_S + 0.01)
    assert (transport.motion, transport.time_s) == (MOTIONS[0], 0.0)


def test_keys_pause_and_step():
    transport = Transport(MOTIONS, speed=1.0)
    transport.advance(0.5)
    transport.press(SPACE)
    transport.advance(9.0)
    assert transport.time_s == pytest.approx(0.5)
    assert "0.50 s (paused)" in transport.caption[1]
    transport.press(SPACE)
    transport.advance(0.1)
    assert transport.time_s == pytest.approx(0.6)
    transport.press(RIGHT)
    transport.press(RIGHT)
    transport.press(LEFT)
    transport.advance(9.0)
    assert transport.time_s == pytest.approx(0.6 + STEP_S)
    for _ in range(100):
        transport.press(LEFT)
    assert transport.time_s == 0.0
    transport.press(ord("Q"))  # means nothing
    assert transport.time_s == 0.0


class FakeWindow:
    """Closed by its user after some redraws; keeps what it showed."""

    def __init__(self, model, data, interval_s, on_key):
        self.data, self.shown, self.closed = data, [], False
        FakeWindow.last = self
        on_key(RIGHT)

    @property
    def is_open(self):
        return len(self.shown) < 3

    def sync(self, caption):
        self.shown.append((self.data.qpos.copy(), caption))

    def close(self):
        self.closed = True


def test_a_window_shows_the_motion_until_it_is_closed(monkeypatch):
    monkeypatch.setattr(playback, "Window", FakeWindow)
    play(MOTIONS, 1.0)
    window = FakeWindow.last
    assert window.closed
    row = round(STEP_S / EnvConfig().robot.physics_step_s)
    for qpos, caption in window.shown:
        np.testing.assert_array_equal(qpos, MOTIONS[0].qpos[row])
        assert caption[1].startswith("21 mm\n")


def test_without_a_display_there_is_a_remedy_instead_of_a_window(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(SurmountError, match=r"no display.*xvfb-run, or draw frames"):
        play(MOTIONS, 1.0)


def test_a_display_that_is_not_there_is_no_display(monkeypatch):
    pytest.importorskip("glfw")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("DISPLAY", ":98765")
    with pytest.raises(SurmountError, match=r"No window could be opened.*98765"):
        play(MOTIONS, 1.0)
