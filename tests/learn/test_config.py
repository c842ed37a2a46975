"""Times in seconds are worth the same at every step."""

from __future__ import annotations

import math

import pytest

from surmount.core.configuration import override
from surmount.core.errors import ConfigError
from surmount.learn.config import LearnerConfig
from surmount.learn.presets import LEARNERS, ML_AGENTS, learner_preset, ml_agents_learner

SECONDS = LearnerConfig(discount_time_s=5.0, gae_time_s=0.5, noise_correlation_s=0.1)


def test_credit_and_noise_in_seconds_are_exponentials_of_the_decision_interval():
    rates = SECONDS.at_interval(0.01)
    assert rates.discount == pytest.approx(math.exp(-0.002), rel=1e-15)
    assert rates.gae_lambda == pytest.approx(math.exp(-0.02), rel=1e-15)
    assert rates.noise_correlation == pytest.approx(math.exp(-0.1), rel=1e-15)


def test_twice_the_interval_squares_them():
    short, long = SECONDS.at_interval(0.01), SECONDS.at_interval(0.02)
    for name in ("discount", "gae_lambda", "noise_correlation"):
        assert getattr(long, name) == pytest.approx(getattr(short, name) ** 2, rel=1e-14)


def test_without_times_the_values_per_decision_hold_at_every_interval():
    config = LearnerConfig(discount=0.97, gae_lambda=0.9)
    for interval_s in (0.005, 0.02, 1.0):
        rates = config.at_interval(interval_s)
        assert (rates.discount, rates.gae_lambda, rates.noise_correlation) == (0.97, 0.9, 0.0)
    seconds = LearnerConfig(discount_time_s=1.0, gae_lambda=0.9)
    assert seconds.at_interval(0.5).gae_lambda == 0.9


def test_times_need_a_decision_that_takes_time():
    with pytest.raises(ConfigError, match=r"takes 0\.0 s"):
        SECONDS.at_interval(0.0)
    assert LearnerConfig().at_interval(0.0).discount == 0.99


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("discount_time_s", 0.0),
        ("gae_time_s", -1.0),
        ("gae_time_s", math.inf),
        ("noise_correlation_s", -0.1),
        ("noise_correlation_s", math.nan),
        ("action_divisor", 0.0),
        ("policy_head_scale", 0.0),
        ("adam_epsilon", 0.0),
        ("decay_steps", 0),
        ("time_horizon", 0),
        ("max_gradient_norm", 0.0),
    ],
)
def test_values_out_of_range_are_refused_by_name(name, value):
    with pytest.raises(ConfigError, match=name):
        LearnerConfig(**{name: value})


def test_the_paper_like_learner_is_a_list_of_changes_and_takes_more():
    prefixless = {key.removeprefix("learner."): value for key, value in ML_AGENTS.items()}
    learner = ml_agents_learner(discount_time_s=5, hidden_layers=[64])
    assert learner == override(
        LearnerConfig(), {**prefixless, "discount_time_s": 5.0, "hidden_layers": [64]}
    )
    defaults = vars(LearnerConfig())
    assert all(defaults[name] != value for name, value in prefixless.items())
    assert learner_preset("surmount") == LearnerConfig()
    assert set(LEARNERS) == {"surmount", "ml-agents"}


def test_unknown_learners_and_fields_are_refused():
    with pytest.raises(ConfigError, match="ml-agents"):
        learner_preset("mlagents")
    with pytest.raises(ConfigError, match="discount_time_s"):
        ml_agents_learner(discount_times=5.0)
