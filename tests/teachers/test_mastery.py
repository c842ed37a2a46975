"""Mastery-gated levels are skipped, left and gone back from by the success of their own group."""

from __future__ import annotations

import numpy as np
import pytest
from toy_learner import toy_curriculum

from surmount.core.errors import ConfigError
from surmount.tasks.regions import Regions
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.mastery import MasteryConfig, MasteryTeacher

ADVANCEMENT = AdvancementConfig(
    iteration_steps=2_000, extension_steps=1_000, window_steps=500, max_extensions=3
)
TASKS = (0.1, 0.5, 0.9)
"""One of each group."""


def teacher_of(**changes) -> MasteryTeacher:
    return MasteryTeacher(
        toy_curriculum(),
        ADVANCEMENT,
        total_steps=10**6,
        seed=0,
        config=MasteryConfig(**changes),
    )


def tell(teacher, group: int, episodes: int, success: float) -> None:
    for index in range(episodes):
        good = int((index + 1) * success) > int(index * success)
        teacher.update_on_episode(0.0, 10, np.array([TASKS[group]]), float(good))


def shares(teacher) -> np.ndarray:
    return Regions.of(toy_curriculum()).shares(teacher.distribution())


def test_a_level_is_left_once_its_own_group_succeeds():
    teacher = teacher_of()
    assert teacher.status().label == "level 1 of 2"
    tell(teacher, 0, 100, 1.0)  # another group's success is not its own
    tell(teacher, 1, 49, 1.0)
    assert not teacher.changes
    tell(teacher, 1, 1, 1.0)
    assert [change.kind for change in teacher.changes] == ["left"]
    assert "1,500 steps: level 1 (medium) is left: 100% of its newest 50" in (
        teacher.changes[0].sentence
    )
    assert teacher.status().level == 2
    np.testing.assert_allclose(shares(teacher), [0.2, 0.1, 0.7], atol=1e-9)


def test_a_level_whose_group_succeeds_already_is_skipped():
    teacher = teacher_of()
    tell(teacher, 2, 50, 1.0)
    tell(teacher, 1, 50, 1.0)
    assert [change.kind for change in teacher.changes] == ["left", "skipped"]
    assert teacher.status().label == "after the last level"


def test_a_level_without_success_is_gone_back_from_after_k_and_not_skipped_for_p():
    teacher = teacher_of()
    tell(teacher, 1, 50, 1.0)
    tell(teacher, 2, 199, 0.0)
    assert teacher.status().level == 2
    tell(teacher, 2, 1, 0.0)
    assert teacher.changes[-1].kind == "back"
    assert teacher.status().level == 1
    assert "0% of its newest 50 episodes succeeded, below 5% after 2,000 steps" in (
        teacher.changes[-1].sentence
    )
    tell(teacher, 0, 99, 1.0)
    assert teacher.status().level == 1  # its group still succeeds, but p has not passed
    tell(teacher, 0, 1, 1.0)
    assert teacher.status().level == 2


def test_the_first_level_has_none_to_go_back_to_and_ends_at_the_papers_limit():
    teacher = teacher_of()
    tell(teacher, 1, 499, 0.0)
    assert not teacher.changes
    tell(teacher, 1, 1, 0.0)  # k + 3 p = 5,000 steps
    assert teacher.changes[0].kind == "left"
    assert "after 5,000 steps" in teacher.changes[0].sentence


def test_after_the_last_level_groups_weigh_by_failure_beside_a_uniform_share():
    teacher = teacher_of(last_uniform_share=0.3)
    tell(teacher, 0, 50, 1.0)
    tell(teacher, 2, 50, 0.95)
    tell(teacher, 1, 50, 1.0)
    failure = 1 - (1 + np.array([50, 50, 47])) / 52
    np.testing.assert_allclose(shares(teacher), 0.1 + 0.7 * failure / failure.sum(), atol=1e-9)


@pytest.mark.parametrize(
    "changes",
    [{"back_success": 0.9}, {"leave_success": 1.1}, {"window_episodes": 0},
     {"last_uniform_share": 0.0}],
)  # fmt: skip
def test_settings_out_of_range_are_refused(changes):
    with pytest.raises(ConfigError, match=next(iter(changes))):
        MasteryConfig(**changes)
