import ctypes.util
import os
import subprocess
import sys
import time

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.passive_env_checker import env_render_passive_checker

from surmount.core.errors import SurmountError
from surmount.envs.screen import has_display
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.obstacles import OBSTACLES
from surmount.rstar.course.rendering import backends, open_context
from surmount.rstar.course.single import ObstacleEnv

IDS = [obstacle.gym_id for obstacle in OBSTACLES.values()]
FIXED = {"start": "fixed"}
DRAWS = has_display() or any(ctypes.util.find_library(name) for name in ("EGL", "OSMesa"))
needs_graphics = pytest.mark.skipif(
    not DRAWS, reason="needs a display, EGL (libegl1) or OSMesa (libosmesa6)"
)
needs_display = pytest.mark.skipif(
    not has_display(), reason="needs a display: run under xvfb-run to see windows open"
)


def orange(frame):
    """Pixels of the body's shell."""
    red, green, blue = (frame[..., i].astype(int) for i in range(3))
    return (red > 150) & (red - blue > 80) & (red - green > 50)


@needs_graphics
@pytest.mark.parametrize("gym_id", IDS)
def test_frames_show_the_robot(gym_id):
    env = gymnasium.make(gym_id, render_mode="rgb_array")
    env.reset(seed=0, options=FIXED)
    env_render_passive_checker(env)
    frame = env.render()
    assert frame.shape == (480, 640, 3)
    assert 500 < orange(frame).sum() < 50_000
    env.close()


@needs_graphics
def test_a_batch_gives_one_frame_of_each_environment():
    env = ObstacleVectorEnv("step", 2, render_mode="rgb_array")
    env.reset(seed=0, options={**FIXED, "variant": [21.0, 50.0]})
    low, high = env.render()
    assert low.shape == high.shape == (480, 640, 3)
    assert not np.array_equal(low, high)  # the camera is the same, the step is not
    env.close()
    env.render()  # opens again
    env.close()


@needs_graphics
def test_frames_need_neither_a_display_nor_a_variable_that_says_so():
    code = (
        "from surmount import ObstacleEnv\n"
        "env = ObstacleEnv('step', render_mode='rgb_array')\n"
        "env.reset(seed=0)\n"
        "assert env.render().std() > 10\n"
    )
    bare = {
        name: value
        for name, value in os.environ.items()
        if name not in ("DISPLAY", "WAYLAND_DISPLAY", "MUJOCO_GL", "PYOPENGL_PLATFORM")
    }
    subprocess.run([sys.executable, "-c", code], env=bare, check=True)  # noqa: S603


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have one backend")
def test_backends_follow_the_variable_or_else_the_display(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "MUJOCO_GL"):
        monkeypatch.delenv(name, raising=False)
    assert backends() == ("egl", "osmesa")
    monkeypatch.setenv("DISPLAY", ":0")
    assert backends() == ("default", "egl", "osmesa")
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    assert backends() == ("osmesa",)


def test_where_nothing_can_draw_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setattr("surmount.rstar.course.rendering.backends", lambda: ("nonsense",))
    with pytest.raises(SurmountError, match=r"nonsense.*libegl1 or libosmesa6"):
        open_context(10, 10)


def test_without_a_display_a_window_is_refused_with_a_remedy(monkeypatch):
    monkeypatch.setattr("surmount.rstar.course.window.has_display", lambda: False)
    env = ObstacleEnv("step", render_mode="human")
    env.reset(seed=0)
    with pytest.raises(SurmountError, match="xvfb-run"):
        env.step(np.zeros(3))


@needs_display
def test_a_window_opens_follows_the_simulation_in_real_time_and_closes():
    env = ObstacleEnv("step", render_mode="human")
    env.reset(seed=0, options=FIXED)
    env.step(np.zeros(3))
    begin = time.monotonic()
    for _ in range(25):
        env.step(np.zeros(3))
        assert env.render() is None
    assert time.monotonic() - begin > 0.9 * 25 * 0.02  # at the least: busy machines take longer
    env.close()
