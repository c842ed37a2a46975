"""Optional dependencies and the extras that install them."""

from __future__ import annotations

from surmount.core.errors import MissingExtraError

EXTRAS = {
    "polars": "tables",
    "mujoco": "robot",
    "gymnasium": "robot",
    "torch": "learn",
    "stable_baselines3": "learn",
    "safetensors": "learn",
    "tensorboard": "learn",
    "threadpoolctl": "learn",
    "jinja2": "report",
    "plotly": "report",
    "matplotlib": "report",
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
