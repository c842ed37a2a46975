"""What an environment shows, by its render mode."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import mujoco
import numpy as np
import numpy.typing as npt

from surmount.core.errors import ConfigError
from surmount.rstar.course.rendering import FrameRenderer
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.course.window import Window

RENDER_MODES = ("rgb_array", "human")


class Pictures:
    """Frames of all simulations, or the first one in a window; opened on first use.

    Parameters
    ----------
    simulation
        What to show.
    mode
        One of :data:`RENDER_MODES`, or None for no pictures.
    interval_s
        Simulated time between two pictures, in s.

    Raises
    ------
    ConfigError
        If there is no such mode.
    """

    def __init__(self, simulation: Simulation, mode: str | None, interval_s: float) -> None:
        if mode is not None and mode not in RENDER_MODES:
            raise ConfigError(
                f"`render_mode` is {mode!r}.",
                remedy=f"Choose among {', '.join(RENDER_MODES)}, or None.",
            )
        self._simulation = simulation
        self._mode = mode
        self._interval_s = interval_s
        self._frames = FrameRenderer(simulation.model)
        self._window: Window | None = None
        self._data: mujoco.MjData | None = None

    def render(self) -> tuple[npt.NDArray[np.uint8], ...] | None:
        """Return one frame per simulation, or show the first one in a window."""
        simulation = self._simulation
        if self._mode is None:
            return None
        if self._mode == "rgb_array":
            return tuple(self._frame(env) for env in range(simulation.batch.nsim))
        self._data = simulation.data(0, self._data)
        if self._window is None:
            self._window = Window(simulation.model, self._data, self._interval_s)
        self._window.sync()
        return None

    def _frame(self, env: int) -> npt.NDArray[np.uint8]:
        self._data = self._simulation.data(env, self._data)
        return self._frames.frame(self._data)

    def close(self) -> None:
        """Release graphics."""
        self._frames.close()
        if self._window is not None:
            self._window.close()
            self._window = None
