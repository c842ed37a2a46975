"""Infos of vector environments in Gymnasium's form: every key with a mask, ``_key``."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray
from surmount.rstar.course.episodes import Episodes
from surmount.rstar.course.measures import Measures, features
from surmount.rstar.course.observations import Observations

Infos = dict[str, Any]

INFO_KEYS = {
    "features": "`time_s`, `sprawl_deg`, `fbem_deg`, `distance_m`: the logged features (paper "
    "II-A), the distance in three dimensions from the base to the target point",
    "variant": "size of the episode's obstacle in mm",
    "is_success": "whether the base has passed the target line",
    "diverged": "whether the physics diverged, which ends the episode",
    "covered": "share of the way from the fixed start to the target line that lies behind the "
    "base, 0 to 1",
    "completion_time_s": "time to the target in s; the cap as long as it is not reached (paper "
    "III-D)",
    "sprawl_path_deg": "path length of the sprawl angle so far, Σ\\|Δ\\| in degrees (paper III-D)",
    "fbem_path_deg": "path length of the FBEM angle so far, Σ\\|Δ\\| in degrees (paper III-D)",
}
"""What the infos of every reset and step hold, and what each entry means."""


def step_infos(measures: Measures, episodes: Episodes) -> Infos:
    """Return the infos of all environments, without masks, one row per environment."""
    fbem_deg, sprawl_deg = episodes.path_deg.copy()
    return {
        "features": features(
            measures, episodes.steps, episodes.interval_s, episodes.target_point_m
        ),
        "variant": episodes.variant.copy(),
        "is_success": episodes.success.copy(),
        "diverged": episodes.diverged.copy(),
        "covered": episodes.covered(measures),
        "completion_time_s": episodes.completion_time_s.copy(),
        "sprawl_path_deg": sprawl_deg,
        "fbem_path_deg": fbem_deg,
    }


def with_masks(infos: Infos, everywhere: BoolArray) -> Infos:
    """Add Gymnasium's mask of each key, a copy of ``everywhere``: all environments have it."""
    infos.update(dict.fromkeys(_mask_keys(tuple(infos)), everywhere.copy()))
    return infos


@functools.cache
def _mask_keys(keys: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"_{key}" for key in keys)


def final_infos(observation: Observations, infos: Infos, ended: BoolArray) -> Infos:
    """Return Gymnasium's entries for episodes that end and begin anew in the same step."""
    final_obs = np.full(ended.size, None, dtype=object)
    for env in np.flatnonzero(ended).tolist():
        final_obs[env] = observation[env].copy()
    final_info: Infos = {}
    for key, value in infos.items():
        shown = np.zeros_like(value)
        shown[ended] = value[ended]
        final_info[key], final_info[f"_{key}"] = shown, ended.copy()
    return {
        "final_obs": final_obs,
        "_final_obs": ended.copy(),
        "final_info": final_info,
        "_final_info": ended.copy(),
    }
