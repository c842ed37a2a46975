"""From trials to a curriculum: mixtures, distances, groups, levels, with every reason kept."""

from surmount.analysis.configuration import AnalysisConfig
from surmount.analysis.description import describe_curriculum
from surmount.analysis.determination import determine_curriculum
from surmount.analysis.explanation import explain_analysis
from surmount.analysis.fitting import fit_mixture
from surmount.analysis.hellinger import hellinger, hellinger_matrix
from surmount.analysis.reference import check_distances, check_hellinger
from surmount.analysis.result import Analysis
from surmount.analysis.trust import describe_trust

__all__ = [
    "Analysis",
    "AnalysisConfig",
    "check_distances",
    "check_hellinger",
    "describe_curriculum",
    "describe_trust",
    "determine_curriculum",
    "explain_analysis",
    "fit_mixture",
    "hellinger",
    "hellinger_matrix",
]
