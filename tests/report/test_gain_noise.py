"""The noise of a gain is what gains differ by where nothing is learnt."""

from __future__ import annotations

import numpy as np
import pytest
from trainings import ROLLOUT, TEST, training

from surmount.report.sections.gain_noise import gain_noise

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
