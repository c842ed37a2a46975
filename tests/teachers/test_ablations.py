"""Each ablation takes out one idea of the paper's curriculum and keeps the rest."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from toy_learner import VARIANTS, ToyLearner, toy_context, toy_curriculum, train

from surmount.analysis.configuration import AnalysisConfig
from surmount.core.axis import CONTINUOUS
from surmount.core.errors import ConfigError
from surmount.tasks.cells import TaskCells
from surmount.teachers.ablations import (
    by_parameter_distance,
    easy_to_hard,
    equally_weighted,
    randomly_ordered,
    stepwise,
)
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.catalogue import make_teacher

PAPER = toy_curriculum()
CONFIG = AnalysisConfig()
RATES = np.repeat([0.97, 0.3, 0.0], 7)


def of_groups(count, parameters=("x",)):
    """Return what of the paper's curriculum matters to an ablation by distance."""
    return SimpleNamespace(
        parameters=parameters,
        groups=PAPER.groups[:1] * count,
        success_threshold=0.95,
        axes=(CONTINUOUS,) * len(parameters),
    )


def test_stepwise_levels_hold_their_dominant_group_alone():
    made = stepwise(PAPER)
    assert [level.weights for level in made.levels] == [(0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    assert [level.dominant for level in made.levels] == ["medium", "difficult"]


def test_equal_weights_make_all_levels_alike():
    made = equally_weighted(PAPER)
    assert all(level.weights == pytest.approx((1 / 3,) * 3) for level in made.levels)
    assert made.n_levels == PAPER.n_levels


@pytest.mark.parametrize("seed", range(6))
def test_a_random_order_permutes_the_weights_and_is_never_the_papers(seed):
    made = randomly_ordered(PAPER, seed)
    assert [level.weights for level in made.levels] != [level.weights for level in PAPER.levels]
    for level, paper in zip(made.levels, PAPER.levels, strict=True):
        assert sorted(level.weights) == sorted(paper.weights)
        names = [group.name for group in made.groups]
        assert level.weights[names.index(level.dominant)] == 0.7


def test_random_orders_differ_between_seeds():
    orders = {randomly_ordered(PAPER, seed).levels for seed in range(12)}
    assert len(orders) > 2


def test_distance_in_parameter_space_groups_neighbours_whatever_their_behaviour():
    # Behaviour would put both ends together: they alone succeed.
    variants = np.array([[0.0], [0.1], [0.2], [5.0], [5.1], [5.2], [9.0], [9.1], [9.2]])
    rates = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.9, 0.9, 0.9])
    made = by_parameter_distance(PAPER, variants, rates, AnalysisConfig())
    assert [group.variants[:, 0].tolist() for group in made.groups] == [
        [0.0, 0.1, 0.2],
        [9.0, 9.1, 9.2],
        [5.0, 5.1, 5.2],
    ]
    assert [level.dominant for level in made.levels] == ["medium", "difficult"]


@pytest.mark.parametrize("groups", [1, 2, 3, 4, 5, 7])
def test_distance_in_parameter_space_gives_as_many_groups_also_among_equal_distances(groups):
    line, square = np.arange(16.0)[:, None], np.indices((4, 4), dtype=float).reshape(2, 16).T
    for parameters, variants in ((("x",), line), (("x", "y"), square)):
        paper = of_groups(groups, parameters)
        made = by_parameter_distance(paper, variants, np.linspace(1, 0, 16), CONFIG)
        assert len(made.groups) == groups


def test_distance_in_parameter_space_does_not_depend_on_units():
    found = []
    for variants in (np.arange(18.0), 0.1 * np.arange(18.0) + 7.3, 1e6 * np.arange(18.0)):
        made = by_parameter_distance(PAPER, variants[:, None], np.linspace(1, 0, 18), CONFIG)
        found.append([len(group.variants) for group in made.groups])
    assert found[0] == found[1] == found[2]


def test_distance_in_parameter_space_that_blurs_success_still_trains_its_hardest_group():
    # Behaviour would set the single failing variant apart; nearness hides it in a group.
    rates = np.ones(18)
    rates[9] = 0.8
    made = by_parameter_distance(of_groups(2), np.arange(18.0)[:, None], rates, CONFIG)
    assert all(group.success_rate > 0.95 for group in made.groups)
    assert [level.dominant for level in made.levels] == [made.groups[-1].name]


def test_easy_to_hard_cuts_the_range_from_its_easy_end_with_as_many_levels():
    cells = TaskCells(("x",), VARIANTS)
    for harder in (1, -1):
        made = easy_to_hard(PAPER, cells, RATES, (harder,), AnalysisConfig())
        middles = [group.variants.mean() for group in made.groups]
        assert np.all(np.diff(middles) * harder > 0)
        assert [len(group.variants) for group in made.groups] == [7, 7, 7]
        assert [level.dominant for level in made.levels] == ["medium", "difficult"]
        assert made.levels[1].weights[2] == 0.7


def test_levels_at_a_budget_go_on_with_the_last_level_or_are_cut_off():
    short = AdvancementConfig(
        iteration_steps=200, extension_steps=200, window_steps=50, max_extensions=0
    )
    context = toy_context(total_steps=2_000)
    teacher = make_teacher("stepwise", type(context)(**{**vars(context), "advancement": short}))
    tasks = train(teacher, ToyLearner(0), 100)
    assert len(tasks) == 10
    assert [part.min() > 0.6 for part in tasks] == [False] + [True] * 9
    assert (teacher.status().label, teacher.status().level) == ("after the last level", 2)
    cut = train(make_teacher("stepwise", toy_context(total_steps=2_000)), ToyLearner(0), 100)
    assert len(cut) == 10
    assert max(part.max() for part in cut) < 0.7  # never left its first level


def test_a_curriculum_without_levels_says_so():
    context = toy_context()
    empty = type(PAPER)(**{**vars(PAPER), "levels": ()})
    with pytest.raises(ConfigError, match="no levels"):
        make_teacher("paper", type(context)(**{**vars(context), "curriculum": empty}))
