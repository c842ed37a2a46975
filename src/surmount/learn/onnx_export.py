"""A policy as an ONNX model, for robots and simulators that know nothing of PyTorch."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from surmount.core.errors import InputError
from surmount.core.records import canonical_json, write_atomically
from surmount.learn.rollouts import CLIP_OBSERVATION, EPSILON
from surmount.learn.snapshot import NOISE, TRAINED_ON, Snapshot, action_divisor

OPSET = 18
"""Version of ONNX's operators: old enough for most runtimes."""
OBSERVATION, MEAN, STD = "observation", "action_mean", "action_std"
ACTIVATIONS: Mapping[str, tuple[str, ...]] = {
    "tanh": ("Tanh",),
    "relu": ("Relu",),
    "silu": ("Sigmoid", "Mul"),
}
"""Operators of each activation; two where it is x · sigmoid(x)."""


def export_onnx(network: Snapshot, path: Path) -> None:
    """Write the acting half of a network as one ONNX model.

    Its input ``observation`` has shape ``(row, observation)`` in the environment's own units, in
    single precision; standardising is part of the model. Its outputs are ``action_mean``, shape
    ``(row, action)`` and clipped to [−1, 1], and ``action_std``, shape ``(action,)``: trials draw
    ``clip(mean before clipping + std · noise)``, a deterministic user takes the mean alone. Both
    outputs are divided by what the network's draws are divided by. What the network was trained on,
    and how its noise was correlated over time if it was, stands in the model's metadata as JSON.

    Parameters
    ----------
    network
        A trained network.
    path
        File to write.

    Raises
    ------
    InputError
        If the snapshot is not of the kind that Surmount trains.
    OutputError
        If the file cannot be written.
    """
    graph = _Graph()
    try:
        last = _build(graph, network)
        log_std = network.tensors["policy/log_std"]
    except KeyError as error:
        raise InputError(
            f"The network has no {error}.", remedy="Give a network that Surmount trained."
        ) from error
    divisor = action_divisor(network)
    graph.constant(STD, np.exp(log_std) / divisor)
    actions, observations = log_std.size, graph.inputs
    outputs = [
        helper.make_tensor_value_info(MEAN, TensorProto.FLOAT, ["row", actions]),
        helper.make_tensor_value_info(STD, TensorProto.FLOAT, [actions]),
    ]
    if divisor != 1.0:
        last = graph.add("Div", [last, graph.constant("divisor", divisor)], "divided")
    graph.add("Clip", [last, graph.constant("low", -1.0), graph.constant("high", 1.0)], MEAN)
    model = helper.make_model(
        helper.make_graph(
            graph.nodes,
            "policy",
            [helper.make_tensor_value_info(OBSERVATION, TensorProto.FLOAT, ["row", observations])],
            outputs,
            graph.constants,
        ),
        opset_imports=[helper.make_opsetid("", OPSET)],
        producer_name="surmount",
        ir_version=9,
    )
    told = {TRAINED_ON: canonical_json(network.record.get(TRAINED_ON))}
    if NOISE in network.record:
        told[NOISE] = canonical_json(network.record[NOISE])
    helper.set_model_props(model, told)
    onnx.checker.check_model(model, full_check=True)
    write_atomically(path, model.SerializeToString(deterministic=True))


class _Graph:
    """Nodes and constants, in the order they are added."""

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.constants: list[Any] = []
        self.inputs = 0

    def constant(self, name: str, value: Any) -> str:
        array = np.asarray(value, dtype=np.float32)
        self.constants.append(numpy_helper.from_array(array, name))
        return name

    def add(self, operator: str, inputs: list[str], output: str, **attributes: Any) -> str:
        self.nodes.append(helper.make_node(operator, inputs, [output], **attributes))
        return output


def _build(graph: _Graph, network: Snapshot) -> str:
    """Add everything up to the means before clipping, and return their name."""
    tensors = network.tensors
    layers = [f"policy/mlp_extractor.policy_net.{2 * i}" for i in range(_depth(network))]
    layers.append("policy/action_net")
    graph.inputs = tensors[f"{layers[0]}.weight"].shape[1]
    value = OBSERVATION
    if network.record["normalise_observations"]:
        variance = tensors["normaliser/observation/var"]
        mean = graph.constant("mean", tensors["normaliser/observation/mean"])
        value = graph.add("Sub", [value, mean], "centred")
        scale = graph.constant("scale", np.sqrt(variance + EPSILON))
        value = graph.add("Div", [value, scale], "scaled")
        limits = [
            graph.constant("lowest", -CLIP_OBSERVATION),
            graph.constant("highest", CLIP_OBSERVATION),
        ]
        value = graph.add("Clip", [value, *limits], "standardised")
    activation = ACTIVATIONS[network.record["activation"]]
    for index, layer in enumerate(layers):
        names = [
            graph.constant(f"{part}_{index}", tensors[f"{layer}.{part}"])
            for part in ("weight", "bias")
        ]
        value = graph.add("Gemm", [value, *names], f"linear_{index}", transB=1)
        if index < len(layers) - 1:
            entered = value
            for step, operator in enumerate(activation):
                inputs = [value] if step == 0 else [entered, value]
                value = graph.add(operator, inputs, f"active_{index}_{step}")
    return value


def _depth(network: Snapshot) -> int:
    return len(network.record["hidden_layers"])
