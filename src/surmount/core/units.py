"""Units in names: what stands behind the last underscore, where it is one that people use."""

from __future__ import annotations

import re

_UNITS = {
    "mm": "mm", "cm": "cm", "m": "m", "km": "km",
    "deg": "°", "rad": "rad",
    "N": "N", "Nm": "N·m", "kg": "kg", "g": "g",
    "us": "µs", "ms": "ms", "s": "s", "min": "min", "h": "h", "Hz": "Hz", "kHz": "kHz",
    "V": "V", "mV": "mV", "A": "A", "mA": "mA", "W": "W", "J": "J", "Pa": "Pa", "kPa": "kPa",
    "K": "K", "percent": "%",
}  # fmt: skip
"""Units that names end in, and how they are printed."""
_RATIO = re.compile(r"(.+)p([A-Za-z]+?)(2?)")
"""One unit per another, which may be squared: ``mps``, ``degps``, ``mps2``, ``Nmprad``."""
_OVER_TIME = re.compile(r"(.+)_(mm|cm|m|km|deg|rad)_(s2?)")
"""A speed or an acceleration with the division as an underscore: ``rate_deg_s``."""


def stem_and_unit(name: str) -> tuple[str, str]:
    """Split ``"sprawl_deg"`` into ``("sprawl", "°")``; the unit is empty where there is none."""
    over_time = _OVER_TIME.fullmatch(name)
    if over_time:
        stem, unit, time = over_time.groups()
        return stem, f"{_UNITS[unit]}/{time.replace('2', '²')}"
    stem, _, suffix = name.rpartition("_")
    unit = _unit(suffix) if stem else ""
    return (stem, unit) if unit else (name, "")


def _unit(suffix: str) -> str:
    if suffix in _UNITS:
        return _UNITS[suffix]
    ratio = _RATIO.fullmatch(suffix)
    if ratio and ratio[1] in _UNITS and ratio[2] in _UNITS:
        return f"{_UNITS[ratio[1]]}/{_UNITS[ratio[2]]}{'²' if ratio[3] else ''}"
    return ""
