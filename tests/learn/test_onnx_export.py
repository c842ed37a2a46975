"""An exported policy acts as the network does, in an implementation that is not ours."""

from __future__ import annotations

import json

import gymnasium
import numpy as np
import onnx
import pytest
import torch
from onnx.reference import ReferenceEvaluator
from stable_baselines3.common.policies import ActorCriticPolicy

from surmount.core.errors import InputError
from surmount.learn.mlp import ACTIVATIONS
from surmount.learn.onnx_export import export_onnx
from surmount.learn.rollouts import Actor
from surmount.learn.snapshot import TRAINED_ON, Snapshot, acting_only

OBSERVATIONS = gymnasium.spaces.Box(-np.inf, np.inf, (7,))
ACTIONS = gymnasium.spaces.Box(-1.0, 1.0, (3,))


def network(activation="tanh", *, normalise=True):
    torch.manual_seed(3)
    policy = ActorCriticPolicy(
        OBSERVATIONS,
        ACTIONS,
        lambda _: 0.0,
        net_arch=[16, 12],
        activation_fn=ACTIVATIONS[activation].module,
        log_std_init=-0.7,
    )
    with torch.no_grad():
        policy.action_net.weight *= 100.0  # so that some means leave the limits
    rng = np.random.default_rng(1)
    tensors = {f"policy/{name}": value.numpy() for name, value in policy.state_dict().items()}
    tensors["normaliser/observation/mean"] = rng.normal(size=7) * 50
    tensors["normaliser/observation/var"] = rng.uniform(0.1, 900.0, 7)
    return Snapshot(
        tensors=tensors,
        record={
            "hidden_layers": [16, 12],
            "activation": activation,
            "normalise_observations": normalise,
            TRAINED_ON: {"task": "step"},
        },
    )


@pytest.mark.parametrize("activation", ["tanh", "relu", "silu"])
@pytest.mark.parametrize("normalise", [True, False])
def test_it_acts_as_the_network(tmp_path, activation, normalise):
    original = network(activation, normalise=normalise)
    export_onnx(acting_only(original), tmp_path / "policy.onnx")
    observations = np.random.default_rng(0).normal(size=(200, 7)) * 60
    if not normalise:
        observations /= 60
    mean, std = ReferenceEvaluator(str(tmp_path / "policy.onnx")).run(
        None, {"observation": observations.astype(np.float32)}
    )
    expected = Actor(original, OBSERVATIONS, ACTIONS).act(observations, None)
    assert (np.abs(expected) == 1.0).any()
    assert (np.abs(expected) < 0.9).any()
    # Single precision, sums in another order.
    np.testing.assert_allclose(mean, expected, atol=2e-5)
    np.testing.assert_allclose(std, np.exp(-0.7), rtol=1e-6)


def test_draws_are_divided_as_the_network_does(tmp_path):
    original = network()
    noise = {"correlation_s": 0.1, "step_s": 0.01}
    divided = Snapshot(
        tensors=original.tensors,
        record={**original.record, "action_divisor": 3.0, "exploration_noise": noise},
    )
    export_onnx(divided, tmp_path / "policy.onnx")
    observations = np.random.default_rng(0).normal(size=(200, 7)) * 60
    mean, std = ReferenceEvaluator(str(tmp_path / "policy.onnx")).run(
        None, {"observation": observations.astype(np.float32)}
    )
    expected = Actor(divided, OBSERVATIONS, ACTIONS).act(observations, None)
    usual = Actor(original, OBSERVATIONS, ACTIONS).act(observations, None)
    assert (np.abs(usual) == 1.0).any()
    assert (np.abs(expected) > 1 / 3).any()
    np.testing.assert_allclose(mean, expected, atol=2e-5)
    np.testing.assert_allclose(std, np.exp(-0.7) / 3, rtol=1e-6)
    told = {entry.key: entry.value for entry in onnx.load(tmp_path / "policy.onnx").metadata_props}
    assert json.loads(told["exploration_noise"]) == noise


def test_it_says_what_it_was_trained_on_and_is_the_same_file_every_time(tmp_path):
    for name in ("one", "two"):
        export_onnx(network(), tmp_path / name)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()
    (entry,) = onnx.load(tmp_path / "one").metadata_props
    assert (entry.key, json.loads(entry.value)) == (TRAINED_ON, {"task": "step"})


def test_a_snapshot_without_a_policy_is_refused(tmp_path):
    whole = network()
    tensors = {name: value for name, value in whole.tensors.items() if "action_net" not in name}
    with pytest.raises(InputError, match="action_net"):
        export_onnx(Snapshot(tensors=tensors, record=whole.record), tmp_path / "policy.onnx")
    assert not (tmp_path / "policy.onnx").exists()
