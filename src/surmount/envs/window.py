"""A window in which to watch one simulation."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import time
from typing import Any

import mujoco

from surmount.core.errors import SurmountError
from surmount.envs.rendering import has_display
from surmount.envs.scene import CAMERA

_REMEDY = "Run on a machine with a display (or under xvfb-run), or use render_mode='rgb_array'."


class Window:
    """MuJoCo's viewer, following one simulation in real time.

    Parameters
    ----------
    model, data
        What to show; ``data`` is read at every :meth:`sync`.
    interval_s
        Simulated time between two calls of :meth:`sync`, in s: the least time between them.

    Raises
    ------
    SurmountError
        If there is no display, or the viewer does not open.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, interval_s: float) -> None:
        if not has_display():
            raise SurmountError("There is no display for a window.", remedy=_REMEDY)
        try:
            import mujoco.viewer  # noqa: PLC0415  (needs a display, unlike all else here)

            self._handle: Any = mujoco.viewer.launch_passive(
                model, data, show_left_ui=False, show_right_ui=False
            )
        except Exception as error:
            raise SurmountError(f"No window could be opened: {error}.", remedy=_REMEDY) from error
        self._interval_s = interval_s
        self._next_s = time.monotonic()
        with self._handle.lock():
            self._handle.cam.type = mujoco.mjtCamera.mjCAMERA_FIXED
            self._handle.cam.fixedcamid = model.camera(CAMERA).id

    @property
    def is_open(self) -> bool:
        """Whether nobody has closed the window."""
        return bool(self._handle.is_running())

    def sync(self) -> None:
        """Show the simulation's present state, not before its time has come."""
        time.sleep(max(0.0, self._next_s - time.monotonic()))
        self._next_s = max(self._next_s, time.monotonic() - self._interval_s) + self._interval_s
        if self.is_open:
            self._handle.sync()

    def close(self) -> None:
        """Close the window."""
        self._handle.close()
