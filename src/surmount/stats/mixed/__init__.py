"""The linear mixed model with Kenward and Roger's correction, and its contrasts by network."""

from __future__ import annotations

from surmount.stats.mixed.cells import CellMean, Interaction, MethodContrast
from surmount.stats.mixed.model import MixedModel, mixed_model
from surmount.stats.mixed.network_contrasts import NetworkContrast, network_contrasts

__all__ = [
    "CellMean",
    "Interaction",
    "MethodContrast",
    "MixedModel",
    "NetworkContrast",
    "mixed_model",
    "network_contrasts",
]
