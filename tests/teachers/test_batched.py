"""Thousands of environments ask for tasks by one call; levels follow as they do one by one."""

from __future__ import annotations

import json

import numpy as np
import pytest
from toy_learner import toy_curriculum

from surmount.core.errors import ConfigError, InputError
from surmount.tasks.regions import Regions
from surmount.teachers.advancement import AdvancementConfig
from surmount.teachers.batched import BatchedTeacher
from surmount.teachers.levels import LevelTeacher

ENVS, STEPS = 4096, 8
ADVANCEMENT = AdvancementConfig(
    iteration_steps=4 * ENVS * STEPS, extension_steps=2 * ENVS * STEPS, window_steps=ENVS * STEPS
)


def teacher():
    curriculum = toy_curriculum()
    levels = [curriculum.level_distribution(level) for level in range(curriculum.n_levels)]
    return LevelTeacher(levels, ADVANCEMENT)


def roll_out(batched, rng):
    """Episodes of eight steps; success below a half, rewarded at the end."""
    for step in range(STEPS):
        done = np.full(ENVS, step == STEPS - 1)
        success = batched.tasks[:, 0] < 0.5
        batched.step(1.0 * (done & success), done, success)
        if done.any():
            batched.draw(np.flatnonzero(done))
    return batched.update()


def test_4096_environments_draw_by_one_call_what_the_level_weights_say():
    batched = BatchedTeacher(teacher(), ENVS, seed=0)
    drawn = batched.draw(np.arange(ENVS))
    assert drawn.shape == (ENVS, 1)
    regions = Regions.of(toy_curriculum())
    shares = regions.shares(batched.distribution)
    counted = [
        np.mean((drawn >= low[0]) & (drawn <= high[0]))
        for low, high in zip(regions.lower, regions.upper, strict=True)
    ]
    # Four standard deviations of a share of 4,096 draws, 0.03; groups share their borders.
    np.testing.assert_allclose(counted, shares, atol=0.04)


def test_levels_follow_each_other_as_they_do_one_by_one():
    batched = BatchedTeacher(teacher(), ENVS, seed=0)
    batched.draw(np.arange(ENVS))
    rng = np.random.default_rng(0)
    tests = []
    for _ in range(40):
        if batched.teacher.finished:
            break
        test = roll_out(batched, rng)
        if test is not None:
            tests.append(test)
    assert {test.level for test in tests} == {0, 1}
    assert batched.teacher.finished
    # An episode that succeeds is worth 1: r is the share of tasks below a half in what was drawn.
    assert tests[0].first_episodes == ENVS
    share = tests[0].first_window
    assert 0.4 < share < 0.7


def test_it_goes_on_from_json_as_if_never_stopped():
    first, second = (BatchedTeacher(teacher(), ENVS, seed=3) for _ in range(2))
    rng = np.random.default_rng(0)
    first.draw(np.arange(ENVS))
    roll_out(first, rng)
    second.load_state_dict(json.loads(json.dumps(first.state_dict())))
    for _ in range(3):
        roll_out(first, rng)
        roll_out(second, rng)
    np.testing.assert_array_equal(first.tasks, second.tasks)
    assert first.teacher.state_dict() == second.teacher.state_dict()


def test_an_episode_without_a_task_is_refused():
    batched = BatchedTeacher(teacher(), 3, seed=0)
    with pytest.raises(InputError, match="given no task"):
        batched.step(np.zeros(3), [True, False, False], [False] * 3)


def finished():
    """Four environments, all of whose levels are over."""
    batched = few()
    batched.draw(np.arange(4))
    while not batched.teacher.finished:
        batched.step(np.ones(4), np.ones(4), np.ones(4))
        batched.draw(np.arange(4))
        batched.update()
    return batched


def few(num_envs=4):
    """Levels of one roll-out of one step each."""
    curriculum = toy_curriculum()
    levels = [curriculum.level_distribution(level) for level in range(curriculum.n_levels)]
    short = AdvancementConfig(
        iteration_steps=4, extension_steps=4, window_steps=4, max_extensions=0
    )
    return BatchedTeacher(LevelTeacher(levels, short), num_envs, seed=0)


def test_after_the_last_level_it_goes_on_with_the_last():
    first, second = finished(), few()
    second.load_state_dict(json.loads(json.dumps(first.state_dict())))
    last = toy_curriculum().level_distribution(toy_curriculum().n_levels - 1)
    for batched in (first, second):
        assert batched.distribution.to_record() == last.to_record()
    np.testing.assert_array_equal(first.draw([0, 1]), second.draw([0, 1]))


def test_a_teacher_with_nothing_to_teach_is_refused():
    with pytest.raises(ConfigError, match="nothing to learn"):
        BatchedTeacher(LevelTeacher([], ADVANCEMENT), 4, seed=0)
    with pytest.raises(ConfigError, match="finished already, after 8 steps"):
        BatchedTeacher(finished().teacher, 4, seed=0)


def test_progress_of_another_number_of_environments_is_refused_before_anything_changes():
    batched = few()
    batched.draw(np.arange(4))
    before = batched.state_dict()
    with pytest.raises(InputError, match="of 6 environments, not of 4"):
        batched.load_state_dict(few(6).state_dict() | {"steps": 100})
    assert batched.state_dict() == before


NAN, NO = [np.nan] * 4, [False] * 4


@pytest.mark.parametrize(
    ("rewards", "dones", "success", "said"),
    [
        ([1.0], NO, NO, r"`rewards` has shape \(1,\), not \(4,\)"),
        (1.0, NO, NO, r"`rewards` has shape \(\)"),
        (np.ones((4, 1)), NO, NO, r"`rewards` has shape \(4, 1\)"),
        (NAN, NO, NO, "`rewards` holds nan"),
        ([0, 0, np.inf, 0], NO, NO, "`rewards` holds inf"),
        (np.ones(4), NO[:3], NO, r"`dones` has shape \(3,\)"),
        (np.ones(4), NAN, NO, "`dones` holds nan"),
        (np.ones(4), np.ones(4), NO[:1], r"`success` has shape \(1,\)"),
        (np.ones(4), np.ones(4), NAN, "`success` holds nan"),
        (np.ones(4), np.ones(4), [0, 1, 0.5, 0], "`success` holds 0.5, which is neither 0 nor 1"),
    ],
)
def test_a_step_that_does_not_tell_each_environment_is_refused_before_it_counts(
    rewards, dones, success, said
):
    batched = few()
    batched.draw(np.arange(4))
    before = batched.state_dict()
    with pytest.raises(InputError, match=said):
        batched.step(rewards, dones, success)
    assert batched.state_dict() == before
    batched.update()
    assert batched.teacher.status().steps == 0


def test_success_is_read_only_where_an_episode_ended():
    batched = few()
    batched.draw(np.arange(4))
    batched.step(np.ones(4), [1, 0, 0, 0], [True, np.nan, np.nan, np.nan])
    assert batched.update() is not None
