"""All teachers by name, each with what it is, where it is from, and how it is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypedDict

import numpy as np

from surmount.analysis.configuration import AnalysisConfig
from surmount.core.arrays import FloatArray
from surmount.core.configuration import nearest
from surmount.core.errors import ConfigError
from surmount.core.seeds import derive_seed
from surmount.tasks.cells import TaskCells
from surmount.tasks.curriculum import Curriculum
from surmount.tasks.distribution import TaskDistribution
from surmount.tasks.space import TaskSpace
from surmount.tasks.unit_box import require_distances
from surmount.teachers import ablations
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.alp_gmm import AlpGmmConfig, AlpGmmTeacher
from surmount.teachers.budget import BudgetedLevels
from surmount.teachers.cell_groups import CellGroups
from surmount.teachers.currot import CurrotConfig, CurrotTeacher
from surmount.teachers.frontier import FrontierTeacher
from surmount.teachers.frontier_config import FrontierConfig
from surmount.teachers.given_groups import (
    GivenGroupsConfig,
    given_groups,
    require_boundaries,
)
from surmount.teachers.learnability import LearnabilityConfig, LearnabilityTeacher
from surmount.teachers.learning_progress import LearningProgressConfig, LearningProgressTeacher
from surmount.teachers.levels import LevelTeacher, require_levels
from surmount.teachers.mastery import MasteryConfig, MasteryTeacher
from surmount.teachers.promotion import PromotionTeacher
from surmount.teachers.replay import ReplayConfig, ReplayTeacher
from surmount.teachers.self_paced import SelfPacedConfig, SelfPacedTeacher
from surmount.teachers.success_guided import SuccessGuidedConfig, SuccessGuidedTeacher
from surmount.teachers.teacher import Teacher
from surmount.teachers.uniform import UniformTeacher


@dataclass(frozen=True, kw_only=True)
class TeachersConfig:
    """Settings of the teachers that have some."""

    given_groups: GivenGroupsConfig = field(default_factory=GivenGroupsConfig)
    """Groups that somebody gives."""

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

    mastery: MasteryConfig = field(default_factory=MasteryConfig)
    """Mastery-gated levels."""

    frontier: FrontierConfig = field(default_factory=FrontierConfig)
    """The frontier, of groups by behaviour, of single cells and of groups by parameters."""

    currot: CurrotConfig = field(default_factory=CurrotConfig)
    """CURROT."""

    sgs: SuccessGuidedConfig = field(default_factory=SuccessGuidedConfig)
    """Success-guided sampling."""


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
        For each parameter 1 where larger values, or later categories, are harder, −1 where smaller
        ones are.
    total_steps
        Learning steps, the same for all.
    seed
        Of everything random in the teacher.
    environments
        Number of environments that learn at once.
    target
        Tasks that are wanted in the end; the whole range if ``None``.
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
    target: TaskDistribution | None = None
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
        return TaskCells(self.curriculum.parameters, self.variants, self.curriculum.axes)

    @property
    def space(self) -> TaskSpace:
        """What the teacher's method and settings must fit."""
        whole, variants = self.whole_range, self.variants
        return TaskSpace(
            parameters=self.curriculum.parameters,
            lower=np.minimum(whole.lower.min(axis=0), variants.min(axis=0)),
            upper=np.maximum(whole.upper.max(axis=0), variants.max(axis=0)),
            variants=variants,
            harder=self.harder,
            axes=self.curriculum.axes,
        )


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
    method
        What it needs, in the words of a refusal, of a space with categories: nothing where empty.
    ordered
        Whether it orders tasks by their parameters, so that somebody must say of categories which
        is harder.
    require
        Refuses settings that do not fit the tasks; everything fits where it is ``None``.
    needs_value_errors
        Whether only learners with a critic that estimates advantages can have it.
    by_trials
        Whether it needs groups, and so the trials that these are determined from: in a comparison
        at equal costs it pays for them.
    """

    title: str
    source: str
    make: Callable[[TeacherContext], Teacher]
    needs_value_errors: bool = False
    by_trials: bool = False
    method: str = ""
    ordered: bool = False
    require: Callable[[TeachersConfig, TaskSpace], None] | None = None


def require_space(name: str, space: TaskSpace, teachers: TeachersConfig) -> None:
    """Refuse a teacher that cannot do with a space of tasks, before anything is trained.

    Raises
    ------
    ConfigError
        If there is none of this name, its method makes no sense on an axis, or its settings do not
        fit the tasks.
    """
    entry = find_teacher(name)
    if entry.require is not None:
        entry.require(teachers, space)
    if entry.method:
        require_distances(space.axes, space.parameters, entry.method)
    if entry.ordered and space.harder is None:
        named = [
            parameter
            for parameter, axis in zip(space.parameters, space.axes, strict=True)
            if axis.categorical
        ]
        if named:
            raise ConfigError(
                f"`{name}` orders tasks by their parameters, and nobody says which category of "
                f"`{named[0]}` is harder.",
                remedy="Give the categories from easy to hard, and `harder` in the task space; or "
                "choose another teacher.",
            )


def make_teacher(name: str, context: TeacherContext) -> Teacher:
    """Make a teacher by its name.

    Raises
    ------
    ConfigError
        If there is none of this name, it needs levels and the curriculum has none, or it cannot do
        with these tasks, see :func:`require_space`.
    """
    require_space(name, context.space, context.teachers)
    return find_teacher(name).make(context)


SETTINGS = {
    "given-groups": "given_groups",
    "alp-gmm": "alp_gmm",
    "plr": "plr",
    "learning-progress": "learning_progress",
    "learnability": "learnability",
    "spdl": "spdl",
    "mastery": "mastery",
    "frontier": "frontier",
    "frontier-cells": "frontier",
    "frontier-parameters": "frontier",
    "sgs": "sgs",
    "currot": "currot",
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


def _require_distances_of_variants(_: TeachersConfig, space: TaskSpace) -> None:
    if len(space.variants) == 1:
        raise ConfigError(
            "Variants are to be grouped by the distance of their parameters, and there is one.",
            remedy="Give several variants, or choose another teacher.",
        )


def _levels(curriculum: Curriculum, context: TeacherContext) -> Teacher:
    require_levels(curriculum.levels)
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


def _given_groups(context: TeacherContext) -> Teacher:
    made = given_groups(
        context.curriculum,
        context.variants,
        context.success_rate,
        context.teachers.given_groups,
        context.analysis,
    )
    return _levels(made, context)


def _spdl(context: TeacherContext) -> Teacher:
    begin = context.curriculum.group_distribution(0)
    return SelfPacedTeacher(
        context.whole_range, begin, config=context.teachers.spdl, **context.budget
    )


def _mastery(context: TeacherContext) -> Teacher:
    require_levels(context.curriculum.levels)
    return MasteryTeacher(
        context.curriculum, context.advancement, config=context.teachers.mastery, **context.budget
    )


def _frontier(groups: CellGroups, context: TeacherContext, label: str) -> Teacher:
    config = context.teachers.frontier
    return FrontierTeacher(groups, config=config, label=label, **context.budget)


def _frontier_parameters(context: TeacherContext) -> Teacher:
    made = ablations.by_parameter_distance(
        context.curriculum, context.variants, context.success_rate, context.analysis
    )
    return _frontier(CellGroups.of(context.cells, made), context, "frontier by parameters")


def _sgs(context: TeacherContext) -> Teacher:
    groups = CellGroups.of(context.cells, context.curriculum)
    return SuccessGuidedTeacher(groups, config=context.teachers.sgs, **context.budget)


_PAPER = "Karni et al. 2024"

TEACHERS = {
    "paper": Entry(
        title="the paper's curriculum",
        source=_PAPER,
        make=lambda of: _levels(of.curriculum, of),
        by_trials=True,
    ),
    "uniform": Entry(
        title="uniform",
        source=f"control of {_PAPER}",
        make=lambda of: UniformTeacher(of.whole_range, **of.budget),
    ),
    "hardest": Entry(
        title="hardest group only",
        source="lower bound",
        make=_hardest,
        by_trials=True,
    ),
    "easy-to-hard": Entry(
        title="easy to hard by the parameter",
        source="a designer's guess, with the paper's levels and test",
        make=_easy_to_hard,
        ordered=True,
        by_trials=True,
    ),
    "random-order": Entry(
        title="groups in random order",
        source=f"ablation of {_PAPER}",
        make=_random_order,
        by_trials=True,
    ),
    "equal-weights": Entry(
        title="equal weights in every level",
        source=f"ablation of {_PAPER}",
        make=lambda of: _levels(ablations.equally_weighted(of.curriculum), of),
        by_trials=True,
    ),
    "parameter-distance": Entry(
        title="groups by distance of parameters",
        source=f"ablation of {_PAPER}",
        make=_parameter_distance,
        by_trials=True,
        require=_require_distances_of_variants,
    ),
    "given-groups": Entry(
        title="groups that are given",
        source=f"levels and test of {_PAPER} over groups of somebody else's",
        make=_given_groups,
        by_trials=True,
        require=lambda teachers, space: require_boundaries(teachers.given_groups, space),
    ),
    "stepwise": Entry(
        title="one group at a time",
        source=f"future work of {_PAPER}",
        make=lambda of: _levels(ablations.stepwise(of.curriculum), of),
        by_trials=True,
    ),
    "promote-demote": Entry(
        title="promote and demote",
        source="Rudin et al. 2021",
        make=lambda of: PromotionTeacher(
            of.cells, of.harder, learners=of.environments, **of.budget
        ),
        ordered=True,
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
        method="ALP-GMM",
    ),
    "plr": Entry(
        title="prioritised level replay",
        source="Jiang et al. 2021",
        make=lambda of: ReplayTeacher(of.cells, config=of.teachers.plr, **of.budget),
        needs_value_errors=ReplayTeacher.needs_value_errors,
    ),
    "spdl": Entry(
        title="self-paced",
        source="Klink et al. 2020, 2021",
        make=_spdl,
        by_trials=True,
        method="Self-paced learning",
    ),
    "mastery": Entry(
        title="mastery-gated levels",
        source=f"the levels of {_PAPER}, by success",
        make=_mastery,
        by_trials=True,
    ),
    "frontier": Entry(
        title="frontier of the groups",
        source="Surmount",
        make=lambda of: _frontier(CellGroups.of(of.cells, of.curriculum), of, "frontier"),
        by_trials=True,
    ),
    "frontier-cells": Entry(
        title="frontier of single variants",
        source="ablation of the frontier: nothing is pooled",
        make=lambda of: _frontier(CellGroups.single(of.cells), of, "frontier of variants"),
    ),
    "frontier-parameters": Entry(
        title="frontier of groups by distance of parameters",
        source="ablation of the frontier: no behaviour",
        make=_frontier_parameters,
        by_trials=True,
        require=_require_distances_of_variants,
    ),
    "sgs": Entry(title="success-guided sampling", source="arXiv:2610.12465", make=_sgs),
    "currot": Entry(
        title="CURROT",
        source="Klink et al. 2022",
        make=lambda of: CurrotTeacher(
            of.whole_range, of.target or of.whole_range, config=of.teachers.currot, **of.budget
        ),
        method="CURROT",
    ),
}
"""By the name that the command line takes."""
