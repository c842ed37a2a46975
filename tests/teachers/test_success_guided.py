"""Success-guided sampling draws what succeeds as often as wanted."""

from __future__ import annotations

import numpy as np
import pytest
from toy_learner import VARIANTS, toy_curriculum

from surmount.core.errors import ConfigError
from surmount.tasks.cells import TaskCells
from surmount.teachers.cell_groups import CellGroups
from surmount.teachers.success_guided import (
    SuccessGuidedConfig,
    SuccessGuidedTeacher,
    guided_weights,
)

GROUPS = CellGroups.of(TaskCells(("x",), VARIANTS), toy_curriculum())


def teacher_of(**changes) -> SuccessGuidedTeacher:
    return SuccessGuidedTeacher(
        GROUPS, total_steps=10**6, seed=0, config=SuccessGuidedConfig(**changes)
    )


@pytest.mark.parametrize(("target", "sharpness"), [(0.66, 5.0), (0.5, 1.0)])
def test_the_weight_is_largest_at_the_target(target, sharpness):
    p = np.linspace(0, 1, 1_001)
    weights = guided_weights(p, target, sharpness, 1e-9)
    assert p[weights.argmax()] == pytest.approx(target, abs=1e-3)
    # The logarithm of the weight is κ times one that has no κ in it.
    np.testing.assert_allclose(
        np.log(weights) / sharpness, np.log(guided_weights(p, target, 1.0, 1e-9)), rtol=1e-9
    )


def test_weights_follow_the_formula_step_by_step_over_the_newest_episodes():
    teacher, rng = teacher_of(window_episodes=10), np.random.default_rng(0)
    seen: list[list[float]] = [[] for _ in range(21)]
    for _ in range(400):
        cell = int(rng.integers(20))  # the last is never tried
        success = float(rng.random() < cell / 20)
        teacher.update_on_episode(0.0, 10, VARIANTS[cell], success)
        seen[cell].append(success)
        p = np.array([np.mean(own[-10:]) if own else 0.66 for own in seen])
        expected = (p + 0.05) ** (5 * 0.66) * (1.05 - p) ** (5 * 0.34)
        found = teacher.distribution().weights
        np.testing.assert_allclose(found, expected / expected.sum(), rtol=1e-9)


def test_it_says_which_group_it_practises_most():
    teacher = teacher_of()
    for index in range(60):
        for group, rate in enumerate((1.0, 0.5, 0.0)):
            for cell in np.flatnonzero(GROUPS.group == group):
                teacher.update_on_episode(0.0, 10, VARIANTS[cell], float(index % 2 < 2 * rate))
    assert teacher.changes[-1].group == "medium"
    assert "medium is practised most, 2." in teacher.changes[-1].sentence


@pytest.mark.parametrize("changes", [{"target": 0.0}, {"sharpness": -1.0}, {"window_episodes": 0}])
def test_settings_out_of_range_are_refused(changes):
    with pytest.raises(ConfigError, match=next(iter(changes))):
        SuccessGuidedConfig(**changes)
