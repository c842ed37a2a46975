"""Infos of vector environments in Gymnasium's form: every key with a mask, ``_key``."""

from __future__ import annotations

from typing import Any

import numpy as np

from surmount.core.arrays import BoolArray
from surmount.envs.observations import Observations

Infos = dict[str, Any]


def final_infos(observation: Observations, infos: Infos, ended: BoolArray) -> Infos:
    """Return Gymnasium's entries for episodes that end and begin anew in the same step."""
    final_obs = np.full(ended.size, None, dtype=object)
    for env in np.flatnonzero(ended).tolist():
        final_obs[env] = observation[env].copy()
    final_info: Infos = {}
    for key, value in infos.items():
        if not key.startswith("_"):
            shown = np.zeros_like(value)
            shown[ended] = value[ended]
            final_info[key], final_info[f"_{key}"] = shown, ended.copy()
    return {
        "final_obs": final_obs,
        "_final_obs": ended.copy(),
        "final_info": final_info,
        "_final_info": ended.copy(),
    }
