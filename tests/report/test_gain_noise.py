"""The noise of a gain is what gains differ by where nothing is learnt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from trainings import ROLLOUT, TEST, training

from surmount.learn.training_episodes import TrainingEpisodes
from surmount.report.sections.gain_noise import gain_noise, noise_of_test

WINDOW = 4_000


def test_it_is_the_deviation_of_gains_between_windows_of_the_same_rewards():
    rng = np.random.default_rng(0)
    steps = 0.3 + rng.standard_normal((4_000, ROLLOUT))  # rewards of single learning steps
    windows = steps.reshape(-1, WINDOW).sum(axis=1)
    gains = windows[1::2] - windows[::2]
    # 500 gains: their deviation is known to three per cent.
    assert gain_noise(training(steps.mean(axis=1)), WINDOW) == pytest.approx(gains.std(), rel=0.1)


def test_learning_and_a_change_of_level_are_not_taken_for_noise():
    rng = np.random.default_rng(0)
    noise = 0.01 * rng.standard_normal(400)
    still = gain_noise(training(noise), WINDOW)
    learnt = noise + np.linspace(0, 1, 400)
    learnt[200:] -= 5.0  # a harder level
    found = gain_noise(training(learnt, [TEST]), WINDOW)
    assert found == pytest.approx(still, rel=0.1)


def test_single_odd_rollouts_do_not_make_it():
    rng = np.random.default_rng(0)
    noise = 0.01 * rng.standard_normal(400)
    odd = noise.copy()
    odd[[50, 300]] -= 10.0
    assert gain_noise(training(odd), WINDOW) == pytest.approx(
        gain_noise(training(noise), WINDOW), rel=0.05
    )


def test_few_rollouts_say_nothing():
    assert gain_noise(training(np.zeros(8)), WINDOW) is None
    assert gain_noise(training(np.zeros(9)), WINDOW) == 0.0


def episodes(reward, tests=(), every=500):
    record = TrainingEpisodes(
        budget=every * reward.size,
        steps=every * np.arange(1, reward.size + 1),
        tasks=np.zeros((reward.size, 1)),
        success=reward > 0,
        reward=reward,
        length=np.full(reward.size, every),
    )
    return replace(training(np.zeros(9), tests), record=record)


def by_episodes(first, last, **changes):
    return replace(
        TEST, measure="episode", first_episodes=first, last_episodes=last, rule="ratio", **changes
    )


def test_by_episodes_it_is_the_deviation_of_gains_between_means_of_so_many_episodes():
    # Success or failure, as rewards of episodes are; windows of 8 and of 4.
    rng = np.random.default_rng(0)
    reward = np.where(rng.random(12_000) < 0.2, 5.0, -1.5) + 0.1 * rng.standard_normal(12_000)
    first, last = reward.reshape(1_000, 12)[:, :8], reward.reshape(1_000, 12)[:, 8:]
    gains = last.mean(axis=1) - first.mean(axis=1)
    found = noise_of_test(by_episodes(8, 4), episodes(reward), WINDOW)
    # 1,000 gains: their deviation is known to two or three per cent.
    assert found == pytest.approx(gains.std(), rel=0.08)


def test_by_episodes_learning_and_a_change_of_level_are_not_taken_for_noise():
    rng = np.random.default_rng(0)
    noise = 0.1 * rng.standard_normal(400)
    learnt = noise + np.linspace(0, 5, 400)
    learnt[200:] -= 9.0  # a harder level, begun where TEST left the first one
    still = noise_of_test(by_episodes(5, 5), episodes(noise), WINDOW)
    left = replace(TEST, steps=200 * 500)
    assert noise_of_test(by_episodes(5, 5), episodes(learnt, [left]), WINDOW) == pytest.approx(
        still, rel=0.05
    )


def test_a_test_by_steps_has_the_noise_of_roll_outs_and_one_without_episodes_none():
    rng = np.random.default_rng(0)
    by_steps = training(rng.standard_normal(40))
    assert noise_of_test(TEST, by_steps, WINDOW) == gain_noise(by_steps, WINDOW)
    assert noise_of_test(by_episodes(0, 0), episodes(rng.standard_normal(40)), WINDOW) is None
    assert noise_of_test(by_episodes(5, 5), by_steps, WINDOW) is None
    assert noise_of_test(by_episodes(5, 5), episodes(np.zeros(8)), WINDOW) is None
