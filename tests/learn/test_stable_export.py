"""The ONNX model of a policy of Stable-Baselines3's kind does what the policy does."""

from __future__ import annotations

import numpy as np
import pytest
from any_spaces import make_walk
from onnx.reference import ReferenceEvaluator
from stable_trainings import CASES, CONTRIB, config_of, trainer

from surmount.envs.observations import stacked
from surmount.learn.choice import make_actor
from surmount.learn.stable_export import export_stable_onnx
from surmount.workflow.monitor import SilentMonitor


@pytest.mark.parametrize("name", [
    "auto-multidiscrete-dict", "ppo-normalised", "dqn", "sac", "td3-noise", "recurrent", "pictures",
])  # fmt: skip
def test_it_acts_as_the_policy_does(name, tmp_path):
    if name in CONTRIB:
        pytest.importorskip("sb3_contrib")
    algorithm, arguments, spaces, more = CASES.get(name, ("auto", {}, ("discrete", "image"), {}))
    more = {key: value for key, value in more.items() if key != "frame_stack"}
    config = config_of(algorithm, arguments, more)
    network = trainer(config, spaces, steps=64).run(SilentMonitor()).network
    env = make_walk(*spaces)
    path = tmp_path / "policy.onnx"
    export_stable_onnx(network, path, env.observation_space, env.action_space)
    model = ReferenceEvaluator(str(path))
    act = make_actor(network, env.observation_space, env.action_space).begin(
        5, np.random.default_rng(0), deterministic=True
    )
    env.observation_space.seed(0)
    state = {}
    for moment in range(3):
        seen = stacked([env.observation_space.sample() for _ in range(5)], env.observation_space)
        expected = act(seen)
        inputs = seen if isinstance(seen, dict) else {"observation": seen}
        if name == "recurrent":
            if not state:
                state = {key: np.zeros((1, 5, 8), np.float32) for key in ("hidden", "cell")}
            inputs |= state | {"episode_start": np.full(5, float(moment == 0), np.float32)}
        action, *after = model.run(None, inputs)
        state = dict(zip(("hidden", "cell"), after, strict=False))
        np.testing.assert_allclose(action, expected, atol=1e-5)  # another library's sums
