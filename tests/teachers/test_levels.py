"""The level teacher advances by eq. 5, explains every decision, and loses nothing on resume."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surmount.core.errors import ConfigError, InputError
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.advancement import AdvancementConfig, gain_ratio, passes
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.teacher import Episodes, RolloutOutcome
from surmount.teachers.uniform import UniformTeacher

CONFIG = AdvancementConfig(
    iteration_steps=100, extension_steps=40, window_steps=10, threshold=0.1, max_extensions=3
)
LEVELS = [
    TaskDistribution.uniform(("h",), np.array([float(i)]), np.array([i + 1.0])) for i in range(3)
]


def outcome(rewards) -> RolloutOutcome:
    none = np.empty(0)
    return RolloutOutcome(
        rewards=np.asarray(rewards, dtype=np.float64),
        episodes=Episodes(
            step=none, variant=none, reward=none, length=none, success=none, diverged=none
        ),
    )


def iteration(teacher, length, gain, *, pieces=4):
    """Feed an iteration whose last window sums to `gain` more than its first."""
    rewards = np.zeros(length)
    rewards[-10:] = gain / 10
    tests = [teacher.update_on_rollout(outcome(part)) for part in np.split(rewards, pieces)]
    assert tests[:-1] == [None] * (pieces - 1)
    return tests[-1]


def test_a_level_goes_through_first_iteration_extensions_and_advance():
    teacher = LevelTeacher(LEVELS, CONFIG)
    first = iteration(teacher, 100, gain=50.0)
    # The first test compares the first iteration with itself: 50 / 50.
    assert (first.ratio, first.decision) == (1.0, "extend")
    assert (first.first_window, first.last_window) == (0.0, pytest.approx(50.0))
    second = iteration(teacher, 40, gain=20.0)
    assert (second.ratio, second.decision) == (pytest.approx(0.4), "extend")
    third = iteration(teacher, 40, gain=4.0)
    assert (third.ratio, third.decision) == (pytest.approx(0.08), "advance")
    assert teacher.distribution() is LEVELS[1]
    assert teacher.status().label == "level 2 of 3"
    assert [test.steps for test in teacher.tests] == [100, 140, 180]


def test_after_the_last_extension_it_goes_on_all_the_same():
    teacher = LevelTeacher(LEVELS[:1], CONFIG)
    iteration(teacher, 100, gain=50.0)
    decisions = [iteration(teacher, 40, gain=30.0).decision for _ in range(3)]
    assert decisions == ["extend", "extend", "advance at the limit"]
    assert teacher.finished


@pytest.mark.parametrize(
    ("first", "newest", "decision"),
    [
        (0.0, 0.0, True),  # flat from the beginning: nothing more to wait for
        (-5.0, -5.0, True),  # the reward fell
        (-5.0, 3.0, False),  # it began to grow only now
        (1e-12, 1e-12, False),  # a gain above the floor is a scale, however small
        (10.0, -2.0, True),
        (10.0, 0.999, True),
        (10.0, 1.0, False),  # eq. 5 asks for less than the threshold
    ],
)
def test_eq_5_with_its_denominator_guarded(first, newest, decision):
    assert passes(first, newest, threshold=0.1, gain_floor=0.0) is decision


@given(st.floats(1e-3, 1e6), st.floats(-1e6, 1e6), st.floats(1e-3, 1e3))
def test_eq_5_does_not_depend_on_the_unit_of_reward(first, newest, unit):
    assert gain_ratio(first * unit, newest * unit, gain_floor=0.0) == pytest.approx(
        gain_ratio(first, newest, gain_floor=0.0), rel=1e-9, abs=1e-12
    )


def test_windows_do_not_depend_on_how_rollouts_cut_the_steps():
    rewards = np.random.default_rng(0).normal(size=100)
    whole, parts = LevelTeacher(LEVELS, CONFIG), LevelTeacher(LEVELS, CONFIG)
    expected = whole.update_on_rollout(outcome(rewards))
    for part in np.split(rewards, [3, 9, 11, 50, 95]):
        test = parts.update_on_rollout(outcome(part))
    assert test == expected
    assert expected.first_window == pytest.approx(rewards[:10].sum())
    assert expected.last_window == pytest.approx(rewards[-10:].sum())


def test_every_test_says_what_was_measured_the_threshold_and_the_decision():
    teacher = LevelTeacher(LEVELS, CONFIG)
    sentence = iteration(teacher, 100, gain=50.0).sentence
    for part in ("level 1", "rF = 0", "rL = 50", "= 1.000", "threshold 0.1", "extend by 40 steps"):
        assert part in sentence


@pytest.mark.parametrize("rollouts", range(1, 14))
def test_a_resumed_teacher_goes_on_as_if_never_stopped(rollouts):
    rng = np.random.default_rng(5)
    stream = [outcome(rng.normal(0.01 * i, 1.0, size=20)) for i in range(30)]
    whole, before = LevelTeacher(LEVELS, CONFIG), LevelTeacher(LEVELS, CONFIG)
    for part in stream[:rollouts]:
        before.update_on_rollout(part)
    after = LevelTeacher(LEVELS, CONFIG)
    after.load_state_dict(json.loads(json.dumps(before.state_dict())))
    for part in stream[rollouts:]:
        after.update_on_rollout(part)
    for part in stream:
        whole.update_on_rollout(part)
    assert after.state_dict() == whole.state_dict()
    assert after.tests == whole.tests


def test_progress_of_another_curriculum_is_refused():
    with pytest.raises(InputError, match="another curriculum"):
        LevelTeacher(LEVELS[:2], CONFIG).load_state_dict(LevelTeacher(LEVELS, CONFIG).state_dict())


def test_a_curriculum_without_levels_is_finished_at_once():
    assert LevelTeacher([], CONFIG).finished


def test_the_uniform_teacher_ends_with_its_steps():
    teacher = UniformTeacher(LEVELS[0], 50)
    for _ in range(3):
        assert not teacher.finished
        teacher.update_on_rollout(outcome(np.zeros(20)))
    assert teacher.finished
    assert teacher.status().steps == 60


@pytest.mark.parametrize(
    "change",
    [{"window_steps": 50}, {"iteration_steps": 0}, {"threshold": 0.0}, {"max_extensions": -1}],
)
def test_impossible_settings_are_refused(change):
    with pytest.raises(ConfigError):
        AdvancementConfig(**(vars(CONFIG) | change))
