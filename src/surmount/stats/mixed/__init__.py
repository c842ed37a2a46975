"""The linear mixed model with Kenward and Roger's correction, and its contrasts by network."""

from __future__ import annotations

from surmount.stats.mixed.cells import CellMean, Interaction, MethodContrast
from surmount.stats.mixed.model import MixedModel, mixed_model

__all__ = ["CellMean", "Interaction", "MethodContrast", "MixedModel", "mixed_model"]
