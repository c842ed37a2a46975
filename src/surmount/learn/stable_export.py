"""A policy of Stable-Baselines3's kind as an ONNX model."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any, cast

import gymnasium
import numpy as np
import onnx
import torch
from onnx import helper
from stable_baselines3.common.vec_env import VecNormalize, VecTransposeImage

from surmount.core.errors import InputError, cause
from surmount.core.records import canonical_json, write_atomically
from surmount.learn.model_state import wrappers
from surmount.learn.snapshot import TRAINED_ON, Snapshot
from surmount.learn.stable_actor import StableActor
from surmount.learn.stable_config import ALGORITHM

OPSET = 18
OBSERVATION, ACTION = "observation", "action"
STATES = ("hidden", "cell")
"""Of a recurrent policy: its state before, and ``next_…`` after, shape ``(layer, row, unit)``."""


def export_stable_onnx(
    network: Snapshot,
    path: Path,
    observation_space: gymnasium.Space[Any],
    action_space: gymnasium.Space[Any],
) -> None:
    """Write a policy as one ONNX model that takes the environment's observations.

    There is an input ``observation``, or one for each entry of a dictionary by its name, with rows
    first; pictures have the environment's order of axes. Stacked frames are stacked by the caller.
    The output ``action`` is the deterministic action in the environment's own terms. A recurrent
    policy also takes ``hidden``, ``cell`` and ``episode_start``, zeros and ones at the beginning,
    and returns ``next_hidden`` and ``next_cell``.

    Parameters
    ----------
    network
        A trained network.
    path
        File to write.
    observation_space, action_space
        Spaces of a single environment.

    Raises
    ------
    InputError
        If the network does not fit them, or its policy cannot be written.
    OutputError
        If the file cannot be written.
    """
    actor = StableActor(network, observation_space, action_space)
    module = _Deterministic(actor)
    file = io.BytesIO()
    try:
        with warnings.catch_warnings():  # that shapes are taken as they are, and of the exporter
            warnings.simplefilter("ignore")
            torch.onnx.export(
                module,
                module.example(),
                file,  # type: ignore[arg-type] - documented to take it
                input_names=module.inputs,
                output_names=module.outputs,
                dynamic_axes={name: {_row_axis(name): "row"}
                              for name in (*module.inputs, *module.outputs)},
                opset_version=OPSET,
                dynamo=False,
            )  # fmt: skip
    except Exception as error:  # whatever PyTorch cannot translate
        raise InputError(
            f"PyTorch cannot write this policy as ONNX ({cause(error)}).",
            remedy="Use it from Python: surmount evaluate, or surmount export --to acting.",
        ) from error
    model = onnx.load_from_string(file.getvalue())
    told = {
        TRAINED_ON: canonical_json(network.record.get(TRAINED_ON)),
        ALGORITHM: canonical_json(network.record[ALGORITHM]),
    }
    helper.set_model_props(model, told)
    onnx.checker.check_model(model, full_check=True)
    write_atomically(path, model.SerializeToString(deterministic=True))


def _row_axis(name: str) -> int:
    return 1 if name.removeprefix("next_") in STATES else 0


class _Deterministic(torch.nn.Module):
    """What a model's ``predict`` does without drawing, in PyTorch alone."""

    def __init__(self, actor: StableActor) -> None:
        super().__init__()
        model: Any = actor.model
        self.policy = model.policy
        self.space = model.action_space
        # Between the environment and the policy; in a frame stack the statistics are behind it.
        self.seen = _before_transposing(model)
        self.entries = (
            list(self.seen.spaces) if isinstance(self.seen, gymnasium.spaces.Dict) else [""]
        )
        self.recurrent = hasattr(self.policy, "lstm_actor")
        self.inputs = [name or OBSERVATION for name in self.entries]
        self.outputs = [ACTION]
        if self.recurrent:
            self.inputs += [*STATES, "episode_start"]
            self.outputs += [f"next_{name}" for name in STATES]
        chain = wrappers(model)
        self.transposed = any(isinstance(one, VecTransposeImage) for one in chain)
        normaliser = next((one for one in chain if isinstance(one, VecNormalize)), None)
        self.scales: dict[str, tuple[torch.Tensor, torch.Tensor, float]] = {}
        if normaliser is not None and normaliser.norm_obs:
            named = normaliser.obs_rms
            parts = named if isinstance(named, dict) else {"": named}
            for name, statistics in parts.items():
                deviation = np.sqrt(statistics.var + normaliser.epsilon)
                self.scales[name] = (
                    torch.as_tensor(np.asarray(statistics.mean, dtype=np.float32)),
                    torch.as_tensor(np.asarray(deviation, dtype=np.float32)),
                    normaliser.clip_obs,
                )

    def example(self) -> tuple[torch.Tensor, ...]:
        """Return inputs of two rows."""
        spaces = (
            self.seen.spaces if isinstance(self.seen, gymnasium.spaces.Dict) else {"": self.seen}
        )
        rows = [torch.as_tensor(np.stack([spaces[name].sample() for _ in range(2)]))
                for name in self.entries]  # fmt: skip
        if self.recurrent:
            lstm: torch.nn.LSTM = self.policy.lstm_actor
            zeros = torch.zeros(lstm.num_layers, 2, lstm.hidden_size)
            rows += [zeros, zeros, torch.ones(2)]
        return tuple(rows)

    def forward(self, *inputs: torch.Tensor) -> Any:
        """Return the action, and the next state of a recurrent policy."""
        named = {
            name: self._as_in_training(name, value)
            for name, value in zip(self.entries, inputs, strict=False)
        }
        observation: Any = named[""] if self.entries == [""] else named
        if self.recurrent:
            hidden, cell, start = inputs[len(self.entries) :]
            distribution, (hidden, cell) = self.policy.get_distribution(
                observation, (hidden, cell), start
            )
            action = distribution.get_actions(deterministic=True)
            return self._in_its_terms(action), hidden, cell
        return self._in_its_terms(self.policy._predict(observation, deterministic=True))  # noqa: SLF001

    def _as_in_training(self, name: str, value: torch.Tensor) -> torch.Tensor:
        if name in self.scales:
            mean, deviation, bound = self.scales[name]
            value = torch.clamp((value.float() - mean) / deviation, -bound, bound)
        spaces: Any = self.policy.observation_space
        kept = spaces[name] if name else spaces
        if self.transposed and value.dim() == 4 and tuple(value.shape[1:]) != kept.shape:
            value = value.permute(0, 3, 1, 2)
        return value

    def _in_its_terms(self, action: torch.Tensor) -> torch.Tensor:
        if not isinstance(self.space, gymnasium.spaces.Box):
            return action
        low, high = (torch.as_tensor(end) for end in (self.space.low, self.space.high))
        if self.policy.squash_output:
            return low + 0.5 * (action + 1.0) * (high - low)
        return torch.minimum(torch.maximum(action, low), high)


def _before_transposing(model: Any) -> gymnasium.Space[Any]:
    """Return the space of observations before Stable-Baselines3 puts channels first."""
    env = model.get_env()
    while isinstance(env, VecTransposeImage):
        env = env.venv
    return cast("gymnasium.Space[Any]", env.observation_space)
