"""All teachers by name, each with what it is, where it is from, and how it is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from surmount.analysis.configuration import AnalysisConfig
from surmount.core.arrays import FloatArray
from surmount.core.configuration import nearest
from surmount.core.curriculum import Curriculum
from surmount.core.errors import ConfigError
from surmount.core.seeds import derive_seed
from surmount.core.tasks import TaskDistribution
from surmount.core.teacher import Teacher
from surmount.teachers import ablations
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.alp_gmm import AlpGmmConfig, AlpGmmTeacher
from surmount.teachers.budget import BudgetedLevels
from surmount.teachers.cells import TaskCells
from surmount.teachers.learnability import LearnabilityConfig, LearnabilityTeacher
from surmount.teachers.learning_progress import LearningProgressConfig, LearningProgressTeacher
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.promotion import PromotionTeacher
from surmount.teachers.replay import ReplayConfig, ReplayTeacher
from surmount.teachers.self_paced import SelfPacedConfig, SelfPacedTeacher
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Brief:
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
    """

    title: str
    source: str
    make: Callable[[Brief], Teacher]


def make_teacher(name: str, brief: Brief) -> Teacher:
    """Make a teacher by its name.

    Raises
    ------
    ConfigError
        If there is none of this name, or it needs levels and the curriculum has none.
    """
    return find_teacher(name).make(brief)


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


def _levels(curriculum: Curriculum, brief: Brief) -> Teacher:
    if not curriculum.levels:
        raise ConfigError(
            "The curriculum has no levels: every group already succeeds.",
            remedy="Shorten the initiation, so that something is left to learn.",
        )
    levels = [curriculum.level_distribution(level) for level in range(curriculum.n_levels)]
    inner = LevelTeacher(levels, brief.advancement, seed=brief.seed)
    return BudgetedLevels(inner, brief.total_steps)


def _paper(brief: Brief) -> Teacher:
    return _levels(brief.curriculum, brief)


def _uniform(brief: Brief) -> Teacher:
    return UniformTeacher(brief.whole_range, brief.total_steps, seed=brief.seed)


def _hardest(brief: Brief) -> Teacher:
    groups = brief.curriculum.groups
    return UniformTeacher(
        brief.curriculum.group_distribution(len(groups) - 1),
        brief.total_steps,
        label=f"{groups[-1].name} group only",
        seed=brief.seed,
    )


def _easy_to_hard(brief: Brief) -> Teacher:
    made = ablations.easy_to_hard(
        brief.curriculum, brief.cells, brief.success_rate, brief.harder, brief.analysis
    )
    return _levels(made, brief)


def _random_order(brief: Brief) -> Teacher:
    seed = derive_seed(brief.seed, "random order")
    return _levels(ablations.randomly_ordered(brief.curriculum, seed), brief)


def _equal_weights(brief: Brief) -> Teacher:
    return _levels(ablations.equally_weighted(brief.curriculum), brief)


def _parameter_distance(brief: Brief) -> Teacher:
    made = ablations.by_parameter_distance(
        brief.curriculum, brief.variants, brief.success_rate, brief.analysis
    )
    return _levels(made, brief)


def _stepwise(brief: Brief) -> Teacher:
    return _levels(ablations.stepwise(brief.curriculum), brief)


def _promotion(brief: Brief) -> Teacher:
    return PromotionTeacher(
        brief.cells,
        brief.harder,
        learners=brief.environments,
        total_steps=brief.total_steps,
        seed=brief.seed,
    )


def _learning_progress(brief: Brief) -> Teacher:
    return LearningProgressTeacher(
        brief.cells,
        total_steps=brief.total_steps,
        seed=brief.seed,
        config=brief.teachers.learning_progress,
    )


def _learnability(brief: Brief) -> Teacher:
    return LearnabilityTeacher(
        brief.cells,
        total_steps=brief.total_steps,
        seed=brief.seed,
        config=brief.teachers.learnability,
    )


def _alp_gmm(brief: Brief) -> Teacher:
    return AlpGmmTeacher(
        brief.whole_range,
        total_steps=brief.total_steps,
        seed=brief.seed,
        config=brief.teachers.alp_gmm,
    )


def _plr(brief: Brief) -> Teacher:
    return ReplayTeacher(
        brief.cells, total_steps=brief.total_steps, seed=brief.seed, config=brief.teachers.plr
    )


def _spdl(brief: Brief) -> Teacher:
    return SelfPacedTeacher(
        brief.whole_range,
        brief.curriculum.group_distribution(0),
        total_steps=brief.total_steps,
        seed=brief.seed,
        config=brief.teachers.spdl,
    )


_PAPER = "Karni et al. 2024"

TEACHERS = {
    "paper": Entry(title="the paper's curriculum", source=_PAPER, make=_paper),
    "uniform": Entry(title="uniform", source=f"control of {_PAPER}", make=_uniform),
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
        title="equal weights in every level", source=f"ablation of {_PAPER}", make=_equal_weights
    ),
    "parameter-distance": Entry(
        title="groups by distance of parameters",
        source=f"ablation of {_PAPER}",
        make=_parameter_distance,
    ),
    "stepwise": Entry(
        title="one group at a time", source=f"future work of {_PAPER}", make=_stepwise
    ),
    "promote-demote": Entry(
        title="promote and demote", source="Rudin et al. 2021", make=_promotion
    ),
    "learning-progress": Entry(
        title="learning progress", source="Kanitscheider et al. 2021", make=_learning_progress
    ),
    "learnability": Entry(
        title="learnability p(1 − p)",
        source="Tzannetos et al. 2023; Rutherford et al. 2024",
        make=_learnability,
    ),
    "alp-gmm": Entry(title="ALP-GMM", source="Portelas et al. 2019", make=_alp_gmm),
    "plr": Entry(title="prioritised level replay", source="Jiang et al. 2021", make=_plr),
    "spdl": Entry(title="self-paced", source="Klink et al. 2020, 2021", make=_spdl),
}
"""By the name that the command line takes."""
