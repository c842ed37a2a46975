"""Whether pictures can be drawn on this machine."""

from __future__ import annotations

import ctypes.util

import numpy as np
import pytest

from surmount.envs.screen import has_display

needs_graphics = pytest.mark.skipif(
    not (has_display() or any(ctypes.util.find_library(name) for name in ("EGL", "OSMesa"))),
    reason="needs a display, EGL (libegl1) or OSMesa (libosmesa6)",
)


def orange(frame: np.ndarray) -> int:
    """Return the number of pixels that show the body's shell."""
    red, green, blue = (frame[..., i].astype(int) for i in range(3))
    return int(((red > 150) & (red - blue > 80) & (red - green > 50)).sum())


def blue(frame: np.ndarray) -> int:
    """Return the number of pixels that show an opaque obstacle."""
    red, _, blue = (frame[..., i].astype(int) for i in range(3))
    return int((blue - red > 70).sum())
