"""Curricula taken to other frameworks, and trials from elsewhere."""

from surmount.exports.formats import FORMATS, Export, export_curriculum
from surmount.exports.ml_agents import export_ml_agents, interval_counts
from surmount.exports.trial_logs import Columns, read_log

__all__ = [
    "FORMATS",
    "Columns",
    "Export",
    "export_curriculum",
    "export_ml_agents",
    "interval_counts",
    "read_log",
]
