"""From trials to a curriculum: mixtures, distances, groups, levels, with every reason kept."""

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.determination import determine_curriculum
from surmount.analysis.explanation import describe_curriculum, explain_analysis
from surmount.analysis.fitting import fit_mixture
from surmount.analysis.hellinger import hellinger, hellinger_matrix
from surmount.analysis.result import Analysis

__all__ = [
    "Analysis",
    "AnalysisConfig",
    "describe_curriculum",
    "determine_curriculum",
    "explain_analysis",
    "fit_mixture",
    "hellinger",
    "hellinger_matrix",
]
