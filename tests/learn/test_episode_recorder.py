"""The one record of episodes counts what happened, wherever roll-outs cut it and runs stopped."""

from __future__ import annotations

import numpy as np
import pytest

from surmount.learn.episode_recorder import EpisodeRecorder

ENVS, MOMENTS, BEFORE = 3, 60, 100


@pytest.mark.parametrize("with_critic", [True, False])
def test_episodes_are_those_of_the_whole_training_wherever_it_was_cut(with_critic):
    rng = np.random.default_rng(0)
    rewards, advantages = rng.normal(size=(2, MOMENTS, ENVS))
    done = rng.random((MOMENTS, ENVS)) < 0.1
    recorder, outcomes = EpisodeRecorder(ENVS, 2, steps=BEFORE), []
    for moment in range(MOMENTS):
        recorder.add(rewards[moment])
        for env in np.flatnonzero(done[moment]).tolist():
            recorder.end(env, variant=[moment, env], success=env == 1, diverged=env == 2)
        if moment % 20 == 19:
            assert recorder.recorded_steps == 20 * ENVS
            rollout = advantages[moment - 19 : moment + 1]
            outcomes.append(recorder.collect(rollout if with_critic else None))
            state, recorder = recorder.state_dict(), EpisodeRecorder(ENVS, 2)
            recorder.load_state_dict(state)
    moments, envs = np.nonzero(done)
    assert np.unique(envs).tolist() == [0, 1, 2]
    spans = []
    for moment, env in zip(moments, envs, strict=True):
        earlier = np.flatnonzero(done[:moment, env])
        spans.append((slice(earlier[-1] + 1 if earlier.size else 0, moment + 1), env))

    def told(name):
        return np.concatenate([getattr(outcome.episodes, name) for outcome in outcomes])

    np.testing.assert_array_equal(told("step"), BEFORE + (moments + 1) * ENVS)
    np.testing.assert_array_equal(told("variant"), np.column_stack([moments, envs]))
    np.testing.assert_array_equal(told("length"), [len(rewards[span]) for span in spans])
    np.testing.assert_array_equal(told("success"), envs == 1)
    np.testing.assert_array_equal(told("diverged"), envs == 2)
    # Sums of up to 60 numbers near 1 in another order.
    np.testing.assert_allclose(told("reward"), [rewards[span].sum() for span in spans], atol=1e-12)
    assert [outcome.steps_before for outcome in outcomes] == [100, 160, 220]
    np.testing.assert_array_equal(
        np.concatenate([outcome.rewards for outcome in outcomes]), rewards.ravel()
    )
    errors = [outcome.value_errors for outcome in outcomes]
    if with_critic:
        expected = [np.abs(advantages[span]).mean() for span in spans]
        np.testing.assert_allclose(np.concatenate(errors), expected, rtol=1e-12)
    else:
        assert errors == [None] * 3


def test_nothing_recorded_is_an_empty_rollout_of_the_right_shape():
    outcome = EpisodeRecorder(2, 3, steps=7).collect()
    assert (outcome.rewards.size, outcome.steps_before) == (0, 7)
    assert outcome.episodes.variant.shape == (0, 3)
