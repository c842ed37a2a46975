"""All teachers by name, each with what it is, where it is from, and how it is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypedDict

from surmount.analysis.configuration import AnalysisConfig
from surmount.core.arrays import FloatArray
from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError
from surmount.core.seeds import derive_seed
from surmount.tasks.cells import TaskCells
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers import ablations
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.alp_gmm import AlpGmmConfig, AlpGmmTeacher
from surmount.teachers.budget import BudgetedLevels
from surmount.teachers.learnability import LearnabilityConfig, LearnabilityTeacher
from surmount.teachers.learning_progress import LearningProgressConfig, LearningProgressTeacher
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.promotion import PromotionTeacher
from surmount.teachers.replay import ReplayConfig, ReplayTeacher
from surmount.teachers.self_paced import SelfPacedConfig, SelfPacedTeacher
from surmount.teachers.teacher import Teacher
from surmount.teachers.uniform import UniformTeacher


@dataclass(frozen=True, kw_only=True)
class TeachersConfig:
    """Settings of the teachers that have some."""

    alp_gmm: AlpGmmConfig = field(default_factory=AlpGmmConfig)
    """ALP-GMM."""

    plr: ReplayConfig = field(default_factory=ReplayConfig)
    """Prioritised level replay."""

    learning_progress: LearningProgressConfig = field(default_factory=LearningProgressConfig)
    """Learning progress."""

    learnability: LearnabilityConfig = field(default_factory=LearnabilityConfig)
    """p(1 − p)."""

    spdl: SelfPacedConfig = field(default_factory=SelfPacedConfig)
    """Self-paced learning."""


class Budget(TypedDict):
    """How long a teacher trains, and the seed of everything random in it."""

    total_steps: int
    seed: int


@dataclass(frozen=True, kw_only=True, eq=False)
class TeacherContext:
    """What teachers are made of: the task, what its analysis found, and the budget.

    Attributes
    ----------
    curriculum
        The paper's curriculum.
    variants, success_rate
        All variants in ascending order and their success after the initiation, shapes
        ``(variant, parameter)`` and ``(variant,)``.
    whole_range
        Uniform over the range of the task parameters.
    harder
        For each parameter 1 where larger values are harder, −1 where smaller ones are.
    total_steps
        Learning steps, the same for all.
    seed
        Of everything random in the teacher.
    environments
        Number of environments that learn at once.
    analysis, advancement, teachers
        Settings.
    """

    curriculum: Curriculum
    variants: FloatArray
    success_rate: FloatArray
    whole_range: TaskDistribution
    harder: tuple[int, ...]
    total_steps: int
    seed: int
    environments: int
    analysis: AnalysisConfig = field(default_factory=AnalysisConfig)
    advancement: AdvancementConfig = field(default_factory=AdvancementConfig)
    teachers: TeachersConfig = field(default_factory=TeachersConfig)

    @property
    def budget(self) -> Budget:
        """What every teacher takes."""
        return {"total_steps": self.total_steps, "seed": self.seed}

    @property
    def cells(self) -> TaskCells:
        """One cell per variant."""
        return TaskCells(self.curriculum.parameters, self.variants)


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A teacher in the catalogue.

    Attributes
    ----------
    title
        Name for people.
    source
        Where it is from.
    make
        Makes it.
    needs_value_errors
        Whether only learners with a critic that estimates advantages can have it.
    """

    title: str
    source: str
    make: Callable[[TeacherContext], Teacher]
    needs_value_errors: bool = False


def make_teacher(name: str, context: TeacherContext) -> Teacher:
    """Make a teacher by its name.

    Raises
    ------
    ConfigError
        If there is none of this name, or it needs levels and the curriculum has none.
    """
    return find_teacher(name).make(context)


SETTINGS = {
    "alp-gmm": "alp_gmm",
    "plr": "plr",
    "learning-progress": "learning_progress",
    "learnability": "learnability",
    "spdl": "spdl",
}
"""Fields of :class:`TeachersConfig` by teacher; the others have no settings of their own."""


def find_teacher(name: str) -> Entry:
    """Return the entry of a name.

    Raises
    ------
    ConfigError
        If there is none, naming the nearest.
    """
    if name not in TEACHERS:
        raise ConfigError(f"Unknown teacher `{name}`.", remedy=nearest(name, [*TEACHERS]))
    return TEACHERS[name]


def _levels(curriculum: Curriculum, context: TeacherContext) -> Teacher:
    if not curriculum.levels:
        raise ConfigError(
            "The curriculum has no levels: every group already succeeds.",
            remedy="Shorten the initiation, so that something is left to learn.",
        )
    levels = [curriculum.level_distribution(level) for level in range(curriculum.n_levels)]
    inner = LevelTeacher(levels, context.advancement, seed=context.seed)
    return BudgetedLevels(inner, context.total_steps)


def _hardest(context: TeacherContext) -> Teacher:
    groups = context.curriculum.groups
    hardest = context.curriculum.group_distribution(len(groups) - 1)
    return UniformTeacher(hardest, label=f"{groups[-1].name} group only", **context.budget)


def _easy_to_hard(context: TeacherContext) -> Teacher:
    made = ablations.easy_to_hard(
        context.curriculum, context.cells, context.success_rate, context.harder, context.analysis
    )
    return _levels(made, context)


def _random_order(context: TeacherContext) -> Teacher:
    seed = derive_seed(context.seed, "random order")
    return _levels(ablations.randomly_ordered(context.curriculum, seed), context)


def _parameter_distance(context: TeacherContext) -> Teacher:
    made = ablations.by_parameter_distance(
        context.curriculum, context.variants, context.success_rate, context.analysis
    )
    return _levels(made, context)


def _spdl(context: TeacherContext) -> Teacher:
    begin = context.curriculum.group_distribution(0)
    return SelfPacedTeacher(
        context.whole_range, begin, config=context.teachers.spdl, **context.budget
    )


_PAPER = "Karni et al. 2024"

TEACHERS = {
    "paper": Entry(
        title="the paper's curriculum",
        source=_PAPER,
        make=lambda of: _levels(of.curriculum, of),
    ),
    "uniform": Entry(
        title="uniform",
        source=f"control of {_PAPER}",
        make=lambda of: UniformTeacher(of.whole_range, **of.budget),
    ),
    "hardest": Entry(title="hardest group only", source="lower bound", make=_hardest),
    "easy-to-hard": Entry(
        title="easy to hard by the parameter",
        source="a designer's guess, with the paper's levels and test",
        make=_easy_to_hard,
    ),
    "random-order": Entry(
        title="groups in random order", source=f"ablation of {_PAPER}", make=_random_order
    ),
    "equal-weights": Entry(
        title="equal weights in every level",
        source=f"ablation of {_PAPER}",
        make=lambda of: _levels(ablations.equally_weighted(of.curriculum), of),
    ),
    "parameter-distance": Entry(
        title="groups by distance of parameters",
        source=f"ablation of {_PAPER}",
        make=_parameter_distance,
    ),
    "stepwise": Entry(
        title="one group at a time",
        source=f"future work of {_PAPER}",
        make=lambda of: _levels(ablations.stepwise(of.curriculum), of),
    ),
    "promote-demote": Entry(
        title="promote and demote",
        source="Rudin et al. 2021",
        make=lambda of: PromotionTeacher(
            of.cells, of.harder, learners=of.environments, **of.budget
        ),
    ),
    "learning-progress": Entry(
        title="learning progress",
        source="Kanitscheider et al. 2021",
        make=lambda of: LearningProgressTeacher(
            of.cells, config=of.teachers.learning_progress, **of.budget
        ),
    ),
    "learnability": Entry(
        title="learnability p(1 − p)",
        source="Tzannetos et al. 2023; Rutherford et al. 2024",
        make=lambda of: LearnabilityTeacher(of.cells, config=of.teachers.learnability, **of.budget),
    ),
    "alp-gmm": Entry(
        title="ALP-GMM",
        source="Portelas et al. 2019",
        make=lambda of: AlpGmmTeacher(of.whole_range, config=of.teachers.alp_gmm, **of.budget),
    ),
    "plr": Entry(
        title="prioritised level replay",
        source="Jiang et al. 2021",
        make=lambda of: ReplayTeacher(of.cells, config=of.teachers.plr, **of.budget),
        needs_value_errors=ReplayTeacher.needs_value_errors,
    ),
    "spdl": Entry(title="self-paced", source="Klink et al. 2020, 2021", make=_spdl),
}
"""By the name that the command line takes."""
