"""Surmount: automatic curriculum determination for reinforcement learning."""

from surmount.analysis import (
    Analysis,
    AnalysisConfig,
    determine_curriculum,
    fit_mixture,
    hellinger,
    hellinger_matrix,
)
from surmount.analysis.mixture import Mixture
from surmount.core.errors import SurmountError
from surmount.tasks.curriculum import Box, Curriculum, Group, Level
from surmount.tasks.distribution import TaskDistribution
from surmount.trials.table import read_trials, trials_from_table, write_trials
from surmount.trials.trials import Trials

__all__ = [
    "Analysis",
    "AnalysisConfig",
    "Box",
    "Curriculum",
    "Group",
    "Level",
    "Mixture",
    "SurmountError",
    "TaskDistribution",
    "Trials",
    "determine_curriculum",
    "fit_mixture",
    "hellinger",
    "hellinger_matrix",
    "read_trials",
    "trials_from_table",
    "write_trials",
]
