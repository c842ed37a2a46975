"""Teachers: give task distributions to environments, take outcomes, decide when to advance."""

from surmount.teachers.advancement import AdvancementConfig, gain_ratio, passes
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.uniform import UniformTeacher

__all__ = ["AdvancementConfig", "LevelTeacher", "UniformTeacher", "gain_ratio", "passes"]
