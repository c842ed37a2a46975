"""Drawing where there is no screen."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Generator

ASKED = "MUJOCO_GL"
"""Variable that says how MuJoCo draws."""


def has_display() -> bool:
    """Return whether there is a screen to draw on."""
    return sys.platform != "linux" or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )


@contextlib.contextmanager
def drawn_off_screen() -> Generator[None]:
    """Let Gymnasium's MuJoCo environments draw by EGL meanwhile, where there is no screen.

    Left to themselves they take GLFW, which needs one. What the user asks for stays.
    """
    if has_display() or os.environ.get(ASKED):
        yield
        return
    os.environ[ASKED] = "egl"
    try:
        yield
    finally:
        del os.environ[ASKED]
