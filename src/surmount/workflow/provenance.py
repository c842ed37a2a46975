"""What a result was made with: versions and machine, recorded beside it."""

from __future__ import annotations

import os
import platform
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, version

PACKAGES = (
    "surmount",
    "numpy",
    "scipy",
    "torch",
    "stable-baselines3",
    "gymnasium",
    "mujoco",
    "polars",
    "safetensors",
)


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that results depend on."""
    found = {"python": sys.version.split()[0]}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def machine() -> dict[str, str]:
    """Return the kind of machine; no name, address or path."""
    return {**kind(), "cores": str(os.cpu_count())}


def provenance() -> dict[str, dict[str, str]]:
    """Return what every record of a result begins with: ``versions`` and ``machine``."""
    return {"versions": versions(), "machine": machine()}


@cache
def kind() -> dict[str, str]:
    """Return what rounding depends on: processor, and the code that libraries choose for it."""
    import torch  # noqa: PLC0415 - slow; only who makes a result needs it

    return {
        "system": f"{platform.system()} {platform.machine()}",
        "processor": _processor(),
        "C library": " ".join(platform.libc_ver()).strip() or "unknown",
        "kernels of PyTorch": torch.backends.cpu.get_cpu_capability(),
        "kernels of BLAS": ", ".join(_blas()) or "unknown",
    }


@cache
def made_with() -> dict[str, str]:
    """Return versions and kind of machine: equal for results that may be compared by their bytes.

    Written into the manifest of every stage, because the stages of a run may be made on several
    machines.
    """
    return versions() | kind()


def _blas() -> list[str]:
    from threadpoolctl import threadpool_info  # noqa: PLC0415 - an extra

    found = [pool for pool in threadpool_info() if pool.get("user_api") == "blas"]
    return sorted(
        {
            f"{pool.get('internal_api')} {pool.get('version')} "
            f"{pool.get('architecture', '')}".strip()
            for pool in found
        }
    )


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:  # noqa: PTH123 - a kernel interface
            for line in file:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or "unknown"
