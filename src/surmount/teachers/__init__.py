"""Teachers: give task distributions to environments, take outcomes, decide when to advance."""

from surmount.teachers.advancement import AdvancementConfig, gain_ratio, passes
from surmount.teachers.alp_gmm import AlpGmmConfig, AlpGmmTeacher
from surmount.teachers.budget import BudgetedLevels
from surmount.teachers.catalogue import (
    TEACHERS,
    TeacherContext,
    TeachersConfig,
    find_teacher,
    make_teacher,
)
from surmount.teachers.cells import TaskCells
from surmount.teachers.learnability import LearnabilityConfig, LearnabilityTeacher
from surmount.teachers.learning_progress import LearningProgressConfig, LearningProgressTeacher
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.promotion import PromotionTeacher
from surmount.teachers.replay import ReplayConfig, ReplayTeacher
from surmount.teachers.self_paced import SelfPacedConfig, SelfPacedTeacher
from surmount.teachers.uniform import UniformTeacher

__all__ = [
    "TEACHERS",
    "AdvancementConfig",
    "AlpGmmConfig",
    "AlpGmmTeacher",
    "BudgetedLevels",
    "LearnabilityConfig",
    "LearnabilityTeacher",
    "LearningProgressConfig",
    "LearningProgressTeacher",
    "LevelTeacher",
    "PromotionTeacher",
    "ReplayConfig",
    "ReplayTeacher",
    "SelfPacedConfig",
    "SelfPacedTeacher",
    "TaskCells",
    "TeacherContext",
    "TeachersConfig",
    "UniformTeacher",
    "find_teacher",
    "gain_ratio",
    "make_teacher",
    "passes",
]
