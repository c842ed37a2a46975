"""Optional dependencies and the extras that install them."""

from __future__ import annotations

import os
import sys
from traceback import walk_tb

from surmount.core.errors import ConfigError, MissingExtraError, SurmountError

EXTRAS = {
    "h5py": "minari",
    "mujoco": "robot",
    "gymnasium": "robot",
    "torch": "learn",
    "stable_baselines3": "learn",
    "safetensors": "learn",
    "sb3_contrib": "contrib",
    "tensorboard": "learn",
    "threadpoolctl": "learn",
    "jinja2": "report",
    "altair": "report",
    "vl_convert": "report",
    "av": "video",
    "PIL": "video",
    "onnx": "onnx",
    "tyro": "cli",
    "rich": "cli",
    "ray": "cluster",
    "fsspec": "cluster",
}
"""Extra that brings each importable package."""


def missing_extra(error: ModuleNotFoundError) -> MissingExtraError | None:
    """Return the error that names the extra for a module that is not installed.

    Returns ``None`` where the module belongs to no extra: then something else is wrong.
    """
    module = (error.name or "").partition(".")[0]
    if module not in EXTRAS:
        return None
    return MissingExtraError(
        f"This needs the package `{module}`, which is not installed.",
        remedy=f"Install it with: pip install 'surmount[{EXTRAS[module]}]' (or 'surmount[lab]' "
        "for everything).",
    )


def told_error(error: Exception) -> SurmountError | None:
    """Return an error as a sentence with a remedy, or None where something else is wrong.

    Besides errors of Surmount's own these are an extra that is missing, and a way to draw that
    MuJoCo was asked for and does not find.
    """
    if isinstance(error, SurmountError):
        return error
    if isinstance(error, ModuleNotFoundError):
        return missing_extra(error)
    asked = os.environ.get("MUJOCO_GL")  # MuJoCo tries it when it is imported
    if not asked or "mujoco" in sys.modules or not _raised_below(error, "mujoco"):
        return None
    return ConfigError(
        f"MuJoCo cannot draw as MUJOCO_GL={asked} asks ({error}).",
        remedy="Unset MUJOCO_GL: a way to draw is found without it.",
    )


def _raised_below(error: Exception, package: str) -> bool:
    """Whether an error came through a package's code."""
    frames = (frame for frame, _ in walk_tb(error.__traceback__))
    return any(frame.f_globals.get("__package__") == package for frame in frames)
