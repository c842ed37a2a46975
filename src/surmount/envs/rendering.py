"""Pictures of simulations: frames off screen, or a window."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from surmount.core.errors import SurmountError
from surmount.envs.scene import CAMERA

FRAME_SIZE = (480, 640)
"""Height and width of a frame in pixels."""


class FrameRenderer:
    """Renders frames of shape ``(height, width, 3)``; opens its graphics context on first use."""

    def __init__(self, model: mujoco.MjModel, size: tuple[int, int] = FRAME_SIZE) -> None:
        self._model = model
        self._size = size
        self._renderer: mujoco.Renderer | None = None

    def frame(self, data: mujoco.MjData, camera: str = CAMERA) -> npt.NDArray[np.uint8]:
        """Return one frame of a simulation with derived quantities computed."""
        if self._renderer is None:
            try:
                self._renderer = mujoco.Renderer(self._model, *self._size)
            except Exception as error:
                raise SurmountError(
                    f"No graphics context for rendering: {error}.",
                    remedy="Without a display, set the environment variable MUJOCO_GL=egl or "
                    "MUJOCO_GL=osmesa before starting.",
                ) from error
        self._renderer.update_scene(data, camera=camera)
        return self._renderer.render().copy()

    def close(self) -> None:
        """Release the graphics context."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None


class Window:
    """MuJoCo's viewer, following one simulation."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        try:
            import mujoco.viewer  # noqa: PLC0415  (needs a display, unlike all else here)

            self._handle: Any = mujoco.viewer.launch_passive(model, data)
        except Exception as error:
            raise SurmountError(
                f"No window could be opened: {error}.",
                remedy="Run on a machine with a display, or use render_mode='rgb_array'.",
            ) from error

    def sync(self) -> None:
        """Show the simulation's present state."""
        self._handle.sync()

    def close(self) -> None:
        """Close the window."""
        self._handle.close()
