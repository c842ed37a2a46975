"""The level teacher advances by eq. 5, explains every decision, and loses nothing on resume."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surmount.core.errors import ConfigError, InputError
from surmount.tasks.distribution import TaskDistribution
from surmount.teachers.advancement import AdvancementConfig, gain_ratio, passes
from surmount.teachers.budget import BudgetedLevels
from surmount.teachers.levels import LevelTeacher
from surmount.teachers.teacher import Episodes, RolloutOutcome
from surmount.teachers.uniform import UniformTeacher

EPISODES = AdvancementConfig(
    iteration_steps=100, extension_steps=40, window_steps=10, threshold=0.1, max_extensions=3
)
CONFIG = replace(EPISODES, measure="step")
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


def ended(steps, episodes, *, before=0) -> RolloutOutcome:
    """A roll-out in which these episodes ended, as (step, reward)."""
    at = np.array([step for step, _ in episodes], dtype=np.int64)
    return RolloutOutcome(
        rewards=np.zeros(steps),
        episodes=Episodes(
            step=before + at,
            variant=np.zeros((at.size, 1)),
            reward=np.array([reward for _, reward in episodes], dtype=np.float64),
            length=np.ones(at.size, dtype=np.int64),
            success=np.zeros(at.size, dtype=np.bool_),
            diverged=np.zeros(at.size, dtype=np.bool_),
        ),
        steps_before=before,
    )


def grown(teacher, length, gain):
    """Feed an iteration whose last episode brings `gain` more than its first."""
    return teacher.update_on_rollout(
        ended(length, [(5, 1.0), (length // 2, 80.0), (length, 1.0 + gain)])
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
        (-5.0, -5.0, True),  # the reward falls still
        (-5.0, 3.0, False),  # it began to grow only now
        (1e-12, 1e-12, False),  # a gain above the floor is a scale, however small
        (10.0, -2.0, True),
        (10.0, 0.999, True),
        (10.0, 1.0, False),  # eq. 5 asks for less than the threshold
        (None, 3.0, False),  # no first gain is no scale either
        (None, 0.0, True),
        (10.0, None, False),  # what cannot be told does not pass
        (-5.0, None, False),
    ],
)
def test_eq_5_from_the_second_test_on(first, newest, decision):
    assert passes(first, newest, iteration=1, threshold=0.1, gain_floor=0.0) is decision


@given(st.none() | st.floats(-1e6, 1e6), st.floats(1e-3, 1e3), st.floats(0, 1e3))
def test_the_first_test_compares_a_gain_with_itself_and_never_passes(gain, threshold, floor):
    assert not passes(gain, gain, iteration=0, threshold=threshold, gain_floor=floor)


@pytest.mark.parametrize("gain", [-50.0, 0.0, 50.0])
def test_no_level_ends_at_its_first_test_unless_no_extension_is_allowed(gain):
    for feed, config in ((iteration, CONFIG), (grown, EPISODES)):
        first = feed(LevelTeacher(LEVELS, config), 100, gain)
        assert (first.rule, first.decision) == ("first test", "extend")
        assert "never passes" in first.sentence
        none = LevelTeacher(LEVELS, replace(config, max_extensions=0))
        assert feed(none, 100, gain).decision == "advance at the limit"


def test_after_a_fall_a_level_is_extended_while_reward_grows():
    teacher = LevelTeacher(LEVELS, EPISODES)
    tests = [grown(teacher, *now) for now in ((100, -5.0), (40, 3.0), (40, 1e-6), (40, 0.0))]
    assert [test.decision for test in tests] == ["extend", "extend", "extend", "advance"]
    assert [test.rule for test in tests] == ["first test", *["newest gain"] * 3]
    assert all(test.ratio is None for test in tests)
    assert "first gain -5 is not above 0" in tests[1].sentence
    assert "+3 is above 0; not passed" in tests[1].sentence
    assert "+0 is not above 0; passed" in tests[3].sentence


def test_a_reward_that_keeps_falling_is_left_at_the_second_test():
    teacher = LevelTeacher(LEVELS, EPISODES)
    assert grown(teacher, 100, -5.0).decision == "extend"
    assert grown(teacher, 40, -2.0).decision == "advance"


def test_an_iteration_in_which_no_gain_can_be_told_is_extended():
    teacher = LevelTeacher(LEVELS, EPISODES)
    none = teacher.update_on_rollout(ended(100, []))
    assert (none.first_window, none.first_gain, none.newest_gain) == (None, None, None)
    assert (none.rule, none.decision) == ("no gain", "extend")
    assert "no episode ended in the iteration" in none.sentence
    one = teacher.update_on_rollout(ended(40, [(20, 3.0)]))
    assert (one.rule, one.decision, one.last_window) == ("no gain", "extend", 3.0)
    assert "both windows hold the same episodes" in one.sentence
    # Told for the first time: there is no first gain to compare with, so its sign decides.
    assert grown(teacher, 40, 2.0).rule == "newest gain"
    assert grown(teacher, 40, 2.0).decision == "advance at the limit"
    json.dumps(teacher.state_dict(), allow_nan=False)


def saturating(tau, config, rollout_steps=10_000):
    """Feed reward 1 - exp(-t / tau) of the steps since the level began; an episode every 100."""
    teacher = LevelTeacher(LEVELS[:1], config)
    steps = 0
    while not teacher.finished:
        at = np.arange(100, rollout_steps + 1, 100)
        reward = 1 - np.exp(-(steps + at) / tau)
        whole = 1 - np.exp(-(steps + np.arange(1, rollout_steps + 1)) / tau)
        told = ended(rollout_steps, list(zip(at, reward, strict=True)), before=steps)
        teacher.update_on_rollout(replace(told, rewards=whole))
        steps += rollout_steps
    return teacher.tests


@pytest.mark.parametrize("measure", ["episode", "step"])
@pytest.mark.parametrize("tau", [0.65e6, 0.675e6, 0.70e6])
def test_a_saturating_reward_ends_the_first_level_where_the_papers_ended(tau, measure):
    config = AdvancementConfig(measure=measure)
    k, p = config.iteration_steps, config.extension_steps
    tests = saturating(tau, config)
    # 1 M of initiation, k and three times p: near 1.8 M steps in all (fig. 7).
    assert 1_000_000 + tests[-1].steps == 1_800_000 == 1_000_000 + k + 3 * p
    assert [test.decision for test in tests] == ["extend"] * 3 + ["advance"]
    assert [test.rule for test in tests] == ["first test"] + ["ratio"] * 3
    extension = np.arange(1, 4)
    # The gains of an exponential between points k + (i - 1) p and k + i p, over that from 0 to k.
    exact = np.exp(-(k + (extension - 1) * p) / tau) * (1 - np.exp(-p / tau))
    exact /= 1 - np.exp(-k / tau)
    assert [ratio < 0.1 for ratio in exact] == [False, False, True]
    # Windows of W instead of points shorten each gain from k to k - W and from p to p - W: 1 % of
    # the first, 5 % of the others.
    found = np.array([test.ratio for test in tests[1:]])
    np.testing.assert_allclose(found, exact, rtol=0.05)
    assert (found < exact).all()


def test_a_faster_reward_ends_the_level_sooner_and_a_slower_one_later():
    lengths = [len(saturating(tau, AdvancementConfig())) - 1 for tau in (0.3e6, 0.5e6, 1e6, 3e6)]
    # Smallest i with exp(-(k + (i - 1) p) / tau) (1 - exp(-p / tau)) / (1 - exp(-k / tau)) < 0.1.
    assert lengths == [1, 2, 5, 10]


@given(
    st.lists(st.floats(-10, 10), min_size=1, max_size=20),
    st.integers(1, 60),
    st.integers(0, 4),
    st.sampled_from(["episode", "step"]),
)
def test_a_level_lasts_k_to_k_and_all_extensions_and_a_roll_out_each(
    rewards, rollout_steps, extensions, measure
):
    config = replace(EPISODES, max_extensions=extensions, measure=measure)
    teacher = LevelTeacher(LEVELS, config)
    count = 0
    while not teacher.finished:
        reward = rewards[count % len(rewards)]
        told = [(1, reward)] if count % 3 else []
        teacher.update_on_rollout(
            replace(
                ended(rollout_steps, told, before=count * rollout_steps),
                rewards=np.full(rollout_steps, reward),
            )
        )
        count += 1
    ends = [test.steps for test in teacher.tests if test.decision != "extend"]
    lengths = np.diff([0, *ends])
    least = 100 + 40 * min(extensions, 1)
    assert (lengths >= least).all()
    assert (lengths <= 100 + 40 * extensions + (1 + extensions) * (rollout_steps - 1)).all()


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
    for part in ("level 1", "rF = 0", "rL = 50", "ratio 1", "threshold 0.1", "extend by 40 steps"):
        assert part in sentence


def test_by_episodes_every_test_says_how_many_and_where_windows_were_too_short():
    teacher = LevelTeacher(LEVELS, EPISODES)
    sentence = grown(teacher, 100, 50.0).sentence
    assert "mean episode reward over the first and last 10 steps" in sentence
    assert "rF = 1 (1 episode), rL = 51 (1 episode)" in sentence
    told = teacher.update_on_rollout(ended(40, [(15, 1.0), (20, 4.0), (20, 6.0)]))
    assert (told.first_episodes, told.last_episodes) == (1, 2)
    assert "1 episode, the first to end, within 15 steps" in told.sentence
    assert "2 episodes, the last to end, within 21 steps" in told.sentence
    assert "= +4 / +50 = 0.080, threshold 0.1; passed" in told.sentence


@pytest.mark.parametrize("config", [CONFIG, EPISODES], ids=["step", "episode"])
@pytest.mark.parametrize("rollouts", range(1, 14))
def test_a_resumed_teacher_goes_on_as_if_never_stopped(rollouts, config):
    rng = np.random.default_rng(5)
    stream = [
        replace(
            ended(20, [(7, float(rng.normal(i))), (20, float(rng.normal(i)))], before=20 * i),
            rewards=rng.normal(0.01 * i, 1.0, size=20),
        )
        for i in range(30)
    ]
    whole, before = LevelTeacher(LEVELS, config), LevelTeacher(LEVELS, config)
    for part in stream[:rollouts]:
        before.update_on_rollout(part)
    after = LevelTeacher(LEVELS, config)
    after.load_state_dict(json.loads(json.dumps(before.state_dict())))
    for part in stream[rollouts:]:
        after.update_on_rollout(part)
    for part in stream:
        whole.update_on_rollout(part)
    assert json.dumps(after.state_dict()) == json.dumps(whole.state_dict())
    assert after.tests == whole.tests


def test_progress_from_before_there_was_a_choice_goes_on_by_steps_and_is_refused_otherwise():
    rewards = np.random.default_rng(0).normal(size=150)
    whole, after = LevelTeacher(LEVELS, CONFIG), LevelTeacher(LEVELS, CONFIG)
    for part in (rewards[:100], rewards[100:120], rewards[120:]):
        whole.update_on_rollout(outcome(part))
    begun = LevelTeacher(LEVELS, CONFIG)
    for part in (rewards[:100], rewards[100:120]):
        begun.update_on_rollout(outcome(part))
    state = begun.state_dict()
    windows = state.pop("windows")
    del state["measure"]
    state |= {"iteration_steps": windows["steps"], "head": windows["head"], "tail": windows["tail"]}
    for test in state["tests"]:
        for name in ("measure", "rule", "first_episodes", "last_episodes"):
            del test[name]
    after.load_state_dict(json.loads(json.dumps(state)))
    after.update_on_rollout(outcome(rewards[120:]))
    assert after.tests[1:] == whole.tests[1:]
    assert (after.tests[0].measure, after.tests[0].rule) == ("step", None)
    with pytest.raises(InputError, match="measures reward by step, not by episode"):
        LevelTeacher(LEVELS, EPISODES).load_state_dict(state)


def test_episodes_told_one_by_one_are_measured_like_those_of_a_roll_out():
    rng = np.random.default_rng(0)
    lengths, rewards = rng.integers(1, 9, 60), rng.normal(size=60)
    told, rolled = LevelTeacher(LEVELS, EPISODES), LevelTeacher(LEVELS, EPISODES)
    steps = 0
    for length, reward in zip(lengths.tolist(), rewards.tolist(), strict=True):
        told.update_on_episode(reward, length, np.zeros(1), 0.0)
        rolled.update_on_rollout(ended(length, [(length, reward)], before=steps))
        steps += length
    assert told.tests == rolled.tests != ()
    spread = LevelTeacher(LEVELS, CONFIG)
    for _ in range(10):
        spread.update_on_episode(5.0, 10, np.zeros(1), 0.0)
    assert spread.tests[0].first_window == pytest.approx(5.0)  # ten steps of one half


def test_progress_of_another_curriculum_is_refused():
    with pytest.raises(InputError, match="another curriculum"):
        LevelTeacher(LEVELS[:2], CONFIG).load_state_dict(LevelTeacher(LEVELS, CONFIG).state_dict())


@pytest.mark.parametrize("budget", [None, 10_000])
def test_it_says_when_a_level_is_tested_and_passes_at_the_earliest(budget):
    levels = LevelTeacher(LEVELS, CONFIG)
    teacher = levels if budget is None else BudgetedLevels(levels, budget)
    said = []
    for steps in (60, 40, 10, 30):
        status = teacher.status()
        said.append((status.level, status.steps_to_test, status.steps_to_next_level))
        teacher.update_on_rollout(outcome(np.zeros(steps)))
    # The first test, after 100, never passes; the one after an extension of 40 does.
    assert said == [(1, 100, 140), (1, 40, 80), (1, 40, 40), (1, 30, 30)]
    assert teacher.status().steps_to_test == 100
    assert teacher.status().level == 2


def test_no_level_follows_the_last_and_without_extensions_the_first_test_ends_one():
    teacher = LevelTeacher(LEVELS[:2], replace(CONFIG, max_extensions=0))
    assert teacher.status().steps_to_next_level == 100
    teacher.update_on_rollout(outcome(np.zeros(100)))
    assert (teacher.status().steps_to_test, teacher.status().steps_to_next_level) == (100, None)
    teacher.update_on_rollout(outcome(np.zeros(100)))
    assert teacher.status().steps_to_test is None


@pytest.mark.parametrize("budget", [None, 10_000])
@pytest.mark.parametrize("draw", ["distribution", "sample"])
def test_a_curriculum_without_levels_has_no_tasks_and_says_so(budget, draw):
    levels = LevelTeacher([], CONFIG)
    teacher = levels if budget is None else BudgetedLevels(levels, budget)
    with pytest.raises(ConfigError, match="has no levels: every group already succeeds"):
        getattr(teacher, draw)()


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
    [
        {"window_steps": 50},
        {"iteration_steps": 0},
        {"threshold": 0.0},
        {"max_extensions": -1},
        {"gain_floor": -1.0},
        {"measure": "decision"},
    ],
)
def test_impossible_settings_are_refused(change):
    with pytest.raises(ConfigError):
        AdvancementConfig(**(vars(CONFIG) | change))
