"""The paper's levels over groups that somebody gives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy_learner import VARIANTS, toy_context, toy_curriculum

from surmount.analysis.configuration import AnalysisConfig
from surmount.core.errors import ConfigError
from surmount.tasks.space import TaskSpace
from surmount.teachers.catalogue import TeachersConfig, make_teacher, require_space
from surmount.teachers.given_groups import GivenGroupsConfig, given_groups

STEP = TaskSpace.grid(step_height_mm=[float(height) for height in range(21, 51)])
PAPERS = GivenGroupsConfig(boundaries=(33.5, 46.5))
RATES = np.repeat([0.94, 0.19, 0.0], [13, 13, 4])


def of_step():
    """Return the one-group curriculum of 30 steps, whose groups are of no account."""
    return replace(toy_curriculum(), parameters=STEP.parameters)


def test_the_papers_groups_of_the_step_are_13_13_and_4_heights_with_three_levels():
    made = given_groups(of_step(), STEP.variants, RATES, PAPERS, AnalysisConfig())
    assert [len(group.variants) for group in made.groups] == [13, 13, 4]
    assert [group.name for group in made.groups] == ["easy", "medium", "difficult"]
    assert [level.dominant for level in made.levels] == ["easy", "medium", "difficult"]


def test_a_group_that_succeeds_has_no_level_and_the_last_one_keeps_its_own():
    config = AnalysisConfig()
    made = given_groups(of_step(), STEP.variants, np.maximum(RATES, 0.96), PAPERS, config)
    assert [level.dominant for level in made.levels] == ["difficult"]
    rates = np.where(STEP.variants[:, 0] < 33.5, 1.0, RATES)
    made = given_groups(of_step(), STEP.variants, rates, PAPERS, config)
    assert [level.dominant for level in made.levels] == ["medium", "difficult"]


def test_groups_are_ranked_by_success_and_not_by_their_place():
    made = given_groups(of_step(), STEP.variants, RATES[::-1], PAPERS, AnalysisConfig())
    assert made.groups[0].variants.min() == 47


def test_the_teacher_practises_the_given_groups():
    context = toy_context()
    middle = float(np.median(VARIANTS))
    teachers = TeachersConfig(given_groups=GivenGroupsConfig(boundaries=(middle + 1e-6,)))
    teacher = make_teacher("given-groups", replace(context, teachers=teachers))
    assert teacher.status().level == 1
    assert teacher.distribution().weights.sum() == pytest.approx(1)


@pytest.mark.parametrize(
    ("boundaries", "says"),
    [
        ((), "has no groups"),
        ((46.5, 33.5), "do not ascend"),
        ((33.5, 33.5), "do not ascend"),
        ((20.0,), "group 1"),
        ((33.2, 33.7, 46.5), "group 2"),
        ((60.0,), "group 2"),
    ],
)
def test_boundaries_that_make_no_groups_are_refused_before_training(boundaries, says):
    teachers = TeachersConfig(given_groups=GivenGroupsConfig(boundaries=boundaries))
    with pytest.raises(ConfigError, match=says):
        require_space("given-groups", STEP, teachers)


def test_making_the_teacher_refuses_settings_that_do_not_fit_the_tasks():
    """Without boundaries it made one group, and taught uniform tasks in silence."""
    with pytest.raises(ConfigError, match=r"has no groups\. .* end on `x`"):
        make_teacher("given-groups", replace(toy_context(), teachers=TeachersConfig()))


@pytest.mark.parametrize("name", ["parameter-distance", "frontier-parameters"])
def test_one_variant_has_no_distance_to_be_grouped_by(name):
    context = toy_context()
    one = replace(context, variants=VARIANTS[:1], success_rate=context.success_rate[:1])
    with pytest.raises(ConfigError, match="distance of their parameters, and there is one"):
        make_teacher(name, one)


@pytest.mark.parametrize(
    "space",
    [
        TaskSpace.grid(slope_deg=[0.0, 10.0], load_kg=[0.0, 1.0]),
        TaskSpace.grid(terrain=["flat", "stairs"]),
    ],
)
def test_spaces_without_one_numeric_parameter_are_refused(space):
    with pytest.raises(ConfigError, match="one numeric task parameter"):
        require_space("given-groups", space, TeachersConfig(given_groups=PAPERS))
