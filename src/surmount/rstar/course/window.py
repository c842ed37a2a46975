"""A window in which to watch one simulation."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import math
import sys
import threading
import time
import warnings
from collections.abc import Callable
from typing import Any

import mujoco

from surmount.core.errors import SurmountError
from surmount.envs.screen import has_display
from surmount.rstar.course.scene import CAMERA

_REMEDY = (
    "Run on a machine with a display (on macOS by mjpython) or under xvfb-run, or draw frames: "
    "`surmount render`, or render_mode='rgb_array'."
)


CLOSING_S = 5.0
"""How long a window may take to close, in s."""


class Window:
    """MuJoCo's viewer, following one simulation in real time.

    Parameters
    ----------
    model, data
        What to show; ``data`` is read at every :meth:`sync`.
    interval_s
        Time between two calls of :meth:`sync`, in s: the least time between them.
    on_key
        Called with the code of every key pressed, in another thread.

    Raises
    ------
    SurmountError
        If there is no display, or the viewer does not open.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        interval_s: float,
        on_key: Callable[[int], None] | None = None,
    ) -> None:
        if not has_display():
            raise SurmountError("There is no display for a window.", remedy=_REMEDY)
        before = set(threading.enumerate())
        try:
            _require_window()
            import mujoco.viewer  # noqa: PLC0415  (needs a display, unlike all else here)

            self._handle: Any = mujoco.viewer.launch_passive(
                model, data, key_callback=on_key, show_left_ui=False, show_right_ui=False
            )
        except Exception as error:
            raise SurmountError(f"No window could be opened: {error}.", remedy=_REMEDY) from error
        self._threads = set(threading.enumerate()) - before
        self._interval_s = interval_s
        self._next_s = time.monotonic()
        with self._handle.lock():
            self._aim(model)

    def _aim(self, model: mujoco.MjModel) -> None:
        """Look from where the camera of the same name does, but so that the mouse can turn it."""
        base, camera = model.body("base").id, model.camera(CAMERA)
        x, y, z = (float(value) for value in camera.pos)
        view = self._handle.cam
        view.type, view.trackbodyid = mujoco.mjtCamera.mjCAMERA_TRACKING, base
        view.distance = math.hypot(x, y, z)
        view.azimuth = math.degrees(math.atan2(-y, -x))
        view.elevation = -math.degrees(math.asin(z / view.distance))

    @property
    def is_open(self) -> bool:
        """Whether nobody has closed the window."""
        return bool(self._handle.is_running())

    def sync(self, caption: tuple[str, str] | None = None) -> None:
        """Show the simulation's present state, not before its time has come.

        Parameters
        ----------
        caption
            Two columns of lines for the upper left corner.
        """
        time.sleep(max(0.0, self._next_s - time.monotonic()))
        self._next_s = max(self._next_s, time.monotonic() - self._interval_s) + self._interval_s
        if self.is_open:
            if caption is not None:
                self._handle.set_texts((None, None, *caption))
            self._handle.sync()

    def close(self) -> None:
        """Close the window and wait until it has gone; a program that ended sooner would crash."""
        self._handle.close()
        for thread in self._threads:
            thread.join(CLOSING_S)


def _require_window() -> None:
    """Raise unless a window can be opened.

    MuJoCo's viewer opens its window in a thread, and would wait for ever for one that failed.
    """
    if sys.platform == "linux":
        import glfw  # noqa: PLC0415  (needs a display)

        with warnings.catch_warnings():
            warnings.simplefilter("error")  # how glfw's bindings report why something failed
            glfw.init()
            glfw.window_hint(glfw.VISIBLE, 0)
            glfw.destroy_window(glfw.create_window(64, 64, "", None, None))
            glfw.default_window_hints()
