"""r over the first and the last W learning steps, by episodes and by steps, counted by hand."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surmount.core.errors import InputError
from surmount.teachers.reward_windows import EpisodeWindows, StepWindows, make_windows

NONE = np.empty(0, dtype=np.int64)


def episodes(windows, steps, ended):
    """Add steps in which these episodes ended, as (step, reward)."""
    ends = np.array([step for step, _ in ended], dtype=np.int64)
    returns = np.array([reward for _, reward in ended], dtype=np.float64)
    windows.add(np.zeros(steps), ends, returns)
    return windows.read()


def test_by_episodes_each_that_ended_within_a_window_counts_once_whatever_its_length():
    read = episodes(
        EpisodeWindows(10),
        100,
        [(1, 2.0), (10, 4.0), (11, 50.0), (90, 70.0), (91, 1.0), (100, 9.0)],
    )
    assert (read.first, read.first_episodes, read.first_steps) == (3.0, 2, 10)
    assert (read.last, read.last_episodes, read.last_steps) == (5.0, 2, 10)
    assert read.gain == 2.0


def test_where_none_ended_within_a_window_the_nearest_to_end_count_together():
    read = episodes(
        EpisodeWindows(10), 100, [(37, 1.0), (37, 3.0), (50, 90.0), (64, 5.0), (64, 6.0)]
    )
    assert (read.first, read.first_episodes, read.first_steps) == (2.0, 2, 37)
    # The last window reaches from step 64 to step 100, both counted.
    assert (read.last, read.last_episodes, read.last_steps) == (5.5, 2, 37)
    assert read.gain == 3.5


def test_without_an_episode_nothing_is_told():
    read = episodes(EpisodeWindows(10), 100, [])
    assert (read.first, read.last, read.gain) == (None, None, None)
    assert (read.first_episodes, read.last_episodes) == (0, 0)


def test_one_episode_alone_tells_no_gain():
    read = episodes(EpisodeWindows(10), 100, [(50, 3.0)])
    assert (read.first, read.last, read.gain) == (3.0, 3.0, None)


def test_by_steps_rewards_are_summed():
    rewards = np.random.default_rng(0).normal(size=100)
    windows = StepWindows(10)
    windows.add(rewards, NONE, np.empty(0))
    read = windows.read()
    assert read.first == pytest.approx(rewards[:10].sum(), rel=1e-12)
    assert read.gain == pytest.approx(rewards[-10:].sum() - rewards[:10].sum(), rel=1e-12)
    assert read.first_episodes is None


def test_capped_episodes_in_short_windows_are_found():
    # Nine environments, capped episodes of 2,000 decisions in step with each other, W = 5,000: an
    # episode in each environment every 18,000 steps, none within the first or the last window.
    ended = [(18_000 * (i + 1), float(i)) for i in range(27) for _ in range(9)]
    read = episodes(EpisodeWindows(5_000), 500_000, ended)
    assert (read.first, read.first_episodes, read.first_steps) == (0.0, 9, 18_000)
    assert (read.last, read.last_episodes, read.last_steps) == (26.0, 9, 500_000 - 486_000 + 1)


@given(
    st.lists(st.integers(1, 120), max_size=12).map(sorted),
    st.lists(st.integers(1, 119), max_size=5).map(sorted),
    st.sampled_from(["episode", "step"]),
)
def test_windows_depend_neither_on_roll_outs_nor_on_being_saved(ends, cuts, measure):
    rng = np.random.default_rng(len(ends))
    rewards, returns, at = rng.normal(size=120), rng.normal(size=len(ends)), np.array(ends, int)
    whole, parts = make_windows(measure, 10), make_windows(measure, 10)
    whole.add(rewards, at, returns)
    for low, high in zip([0, *cuts], [*cuts, 120], strict=True):
        own = (at > low) & (at <= high)
        parts.add(rewards[low:high], at[own] - low, returns[own])
        state = json.loads(json.dumps(parts.state_dict()))
        parts = make_windows(measure, 10)
        parts.load_state_dict(state)
    assert parts.read() == whole.read()
    assert parts.state_dict() == whole.state_dict()
    first = at <= max(10, at.min(initial=120))
    if measure == "episode" and at.size:
        assert whole.read().first == pytest.approx(returns[first].mean(), rel=1e-9)


def test_an_episode_outside_the_rollout_is_refused():
    for step in (0, 21):
        with pytest.raises(InputError, match="steps_before"):
            episodes(EpisodeWindows(10), 20, [(step, 1.0)])
