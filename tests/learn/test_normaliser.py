"""The lean normalisation has the statistics of all rows, and Stable-Baselines3's numbers."""

from __future__ import annotations

import numpy as np
import pytest
from point_env import PointEnv
from stable_baselines3.common.vec_env import VecNormalize

from surmount.learn.normaliser import Normaliser, RunningMoments
from surmount.learn.recorder import Recorder


def test_moments_are_those_of_all_rows_together():
    rng = np.random.default_rng(0)
    batches = [rng.normal(5.0, 2.0, (rows, 3)) for rows in (4, 1, 30)]
    moments = RunningMoments(epsilon=1e-9, shape=(3,))
    for batch in batches:
        moments.update(batch)
    rows = np.concatenate(batches)
    # The prior of mean 0 and variance 1 weighs a billionth of a row.
    np.testing.assert_allclose(moments.mean, rows.mean(axis=0), rtol=1e-8)
    np.testing.assert_allclose(moments.var, rows.var(axis=0), rtol=1e-8)
    assert moments.count == pytest.approx(35)


@pytest.mark.parametrize("observations", [True, False])
@pytest.mark.parametrize("rewards", [True, False])
def test_normalised_steps_are_those_of_stable_baselines3(observations, rewards):
    lean = Normaliser(
        Recorder(PointEnv(5)), observations=observations, rewards=rewards, discount=0.9
    )
    peer = VecNormalize(
        Recorder(PointEnv(5)), norm_obs=observations, norm_reward=rewards, gamma=0.9
    )
    for env in (lean, peer):
        env.seed(3)
    # Stable-Baselines3 takes the moments of each batch in single precision.
    close = {"rtol": 1e-5, "atol": 1e-5}
    np.testing.assert_allclose(lean.reset(), peer.reset(), **close)
    rng = np.random.default_rng(1)
    ended = 0
    for _ in range(100):
        actions = rng.uniform(-0.5, 1.0, (5, 1)).astype(np.float32)
        ours, theirs = lean.step(actions), peer.step(actions)
        for mine, other in zip(ours[:3], theirs[:3], strict=True):
            assert mine.dtype == other.dtype
            np.testing.assert_allclose(mine, other, **close)
        for env in np.flatnonzero(ours[2]):
            ended += 1
            last = [infos[env]["terminal_observation"] for infos in (ours[3], theirs[3])]
            np.testing.assert_allclose(*last, **close)
    assert ended > 5
    np.testing.assert_allclose(lean.ret_rms.var, peer.ret_rms.var, rtol=1e-5)
    np.testing.assert_allclose(lean.returns, peer.returns, rtol=1e-6, atol=1e-9)
