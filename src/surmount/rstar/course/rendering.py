"""Frames of simulations, drawn off screen."""

# MuJoCo's bindings are compiled and carry no annotations.
# pyright: reportAttributeAccessIssue=false, reportUnknownParameterType=false

from __future__ import annotations

import importlib
import os
import sys
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from surmount.core.errors import SurmountError
from surmount.envs.screen import has_display
from surmount.rstar.course.scene import CAMERA

FRAME_SIZE = (480, 640)
"""Height and width of a frame in pixels."""

MAX_GEOMS = 10_000
"""Geoms that a picture may show, decorations included; MuJoCo's own default."""


def backends() -> tuple[str, ...]:
    """Return the OpenGL backends to try, in order: what MUJOCO_GL names, or what may work here."""
    asked = os.environ.get("MUJOCO_GL", "").lower().strip()
    if asked in ("egl", "osmesa"):
        return (asked,)
    if asked or sys.platform != "linux":
        return ("default",)
    return ("default", "egl", "osmesa") if has_display() else ("egl", "osmesa")


def open_context(height: int, width: int) -> Any:
    """Open an OpenGL context to draw frames of so many pixels, and make it current.

    Raises
    ------
    SurmountError
        If no backend works on this machine.
    """
    problems: list[str] = []
    for backend in backends():
        try:
            kind: Any = (
                mujoco.GLContext
                if backend == "default"
                else importlib.import_module(f"mujoco.{backend}").GLContext
            )
            context = kind(width, height)
            context.make_current()
        except Exception as error:  # noqa: BLE001  (each backend fails in its own way)
            problems.append(f"{backend}: {error}")
        else:
            return context
    raise SurmountError(
        f"No graphics context for rendering ({'; '.join(problems)}).",
        remedy="Install EGL or OSMesa (on Debian: apt-get install libegl1 or libosmesa6), or run "
        "on a machine with a display.",
    )


class FrameRenderer:
    """Renders frames of shape ``(height, width, 3)``; opens its graphics context on first use.

    Without a display it draws through EGL or OSMesa, whether or not MUJOCO_GL says so.
    """

    def __init__(self, model: mujoco.MjModel, size: tuple[int, int] = FRAME_SIZE) -> None:
        self._model = model
        self._size = size
        self._gl: Any = None
        self._context: mujoco.MjrContext | None = None
        self._scene: mujoco.MjvScene | None = None
        self._camera = mujoco.MjvCamera()
        self._options = mujoco.MjvOption()

    def frame(self, data: mujoco.MjData, camera: str = CAMERA) -> npt.NDArray[np.uint8]:
        """Return one frame of a simulation with derived quantities computed."""
        height, width = self._size
        if self._gl is None:
            self._gl = open_context(height, width)
            self._context = mujoco.MjrContext(
                self._model, mujoco.mjtFontScale.mjFONTSCALE_150.value
            )
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
            self._scene = mujoco.MjvScene(self._model, maxgeom=MAX_GEOMS)
        self._gl.make_current()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._camera.fixedcamid = self._model.camera(camera).id
        mujoco.mjv_updateScene(
            self._model,
            data,
            self._options,
            None,
            self._camera,
            mujoco.mjtCatBit.mjCAT_ALL.value,
            self._scene,
        )
        viewport = mujoco.MjrRect(0, 0, width, height)
        mujoco.mjr_render(viewport, self._scene, self._context)
        pixels = np.empty((height, width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(pixels, None, viewport, self._context)
        return np.flipud(pixels).copy()

    def close(self) -> None:
        """Release the graphics context."""
        if self._gl is not None:
            self._gl.make_current()
            if self._context is not None:
                self._context.free()
            self._gl.free()
            self._gl = self._context = self._scene = None
