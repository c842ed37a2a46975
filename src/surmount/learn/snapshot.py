"""Networks on disk: weights, optimiser and normalisation in one safetensors file, no pickle.

The file's tensors are named ``policy/…``, ``optimiser/<parameter>/…`` and ``normaliser/…``; its
metadata hold a JSON record with the architecture, so that a snapshot can be used on its own.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import torch
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save
from stable_baselines3 import PPO
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecNormalize

from surmount.core.errors import InputError, IntegrityError, SurmountError
from surmount.core.records import canonical_json, parse_record, write_atomically
from surmount.learn.mlp import ACTIVATIONS
from surmount.workflow.earlier import renamed

Tensors = dict[str, np.ndarray]
SCHEMA = 1
TRAINED_ON = "trained_on"
"""Key of a network's record: the tasks that it was trained on, where the writer tells."""
ACTION_DIVISOR = "action_divisor"
"""Key of a network's record: what draws are divided by before clipping; 1 where it is missing."""
NOISE = "exploration_noise"
"""Key of a network's record: how its exploration noise is correlated over time; not at all where it
is missing. Holds ``correlation_s`` and the ``step_s`` at which it learnt."""
_ACTING = ("policy/", "normaliser/observation/")
_JUDGING = ("policy/value_net.", "policy/mlp_extractor.value_net.")


@dataclass(frozen=True, kw_only=True, eq=False)
class Snapshot:
    """Everything that is carried from one stage of training to the next.

    Attributes
    ----------
    tensors
        Weights, optimiser moments and normalisation statistics by name.
    record
        Architecture and whatever else the writer recorded, as JSON values.
    """

    tensors: Mapping[str, np.ndarray]
    record: Mapping[str, Any]

    def save(self, path: Path, *, sealed: bool = False) -> None:
        """Write one file, atomically.

        Parameters
        ----------
        path
            The file.
        sealed
            Whether to add a hash over everything, for files that no manifest vouches for.
        """
        tensors = {name: np.asarray(array, order="C") for name, array in self.tensors.items()}
        metadata = {"surmount": canonical_json({"schema": SCHEMA, **self.record})}
        if sealed:
            metadata["seal"] = _seal(tensors, metadata["surmount"])
        write_atomically(path, save(tensors, metadata))

    @classmethod
    def load(cls, path: Path, *, sealed: bool = False) -> Snapshot:
        """Read a file written by :meth:`save`.

        Raises
        ------
        InputError
            If the file is missing, damaged, or was not written by Surmount.
        IntegrityError
            If it was to be sealed, and was changed after it was written.
        """
        if not sealed and not path.is_file():
            raise InputError(
                f"{path} {'is a folder' if path.is_dir() else 'does not exist'}.",
                remedy="Give a network's file, such as stages/…/network.safetensors of a run.",
            )
        try:
            with safe_open(path, framework="numpy") as file:
                metadata = cast("dict[str, str]", file.metadata() or {})
                tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
            found = parse_record(metadata["surmount"].encode(), str(path))
        except (
            *(OSError, SafetensorError, SurmountError),
            *(KeyError, ValueError, TypeError, AttributeError),  # a type that NumPy lacks
        ) as error:
            if sealed:
                raise _damaged(path) from error
            raise InputError(
                f"{path} is not a network written by Surmount ({error}).",
                remedy="Give a `network.safetensors` that a run has made.",
            ) from error
        if sealed and metadata.get("seal") != _seal(tensors, metadata["surmount"]):
            raise _damaged(path)
        if found.pop("schema", None) != SCHEMA:
            raise InputError(
                f"{path} was written in another format version.",
                remedy="Read it with the version of Surmount that wrote it.",
            )
        return cls(tensors=tensors, record=found)


def check_architecture(network: Snapshot) -> None:
    """Refuse a network whose record does not describe its tensors, before anything is built.

    Raises
    ------
    InputError
        If the record names layers that the file does not hold, or numbers are not finite.
    """
    layers = network.record.get("hidden_layers")
    flags = network.record.get("normalise_observations")
    kind = network.record.get("activation")
    widths = [
        network.tensors[name].shape[0]
        for index in range(len(network.tensors))
        if (name := f"policy/mlp_extractor.policy_net.{2 * index}.weight") in network.tensors
    ]
    if layers != widths or kind not in ACTIVATIONS or not isinstance(flags, bool):
        raise InputError(
            f"The network's record describes layers {str(layers)[:80]} of kind {str(kind)[:40]}, "
            f"its tensors are {widths}.",
            remedy="Give a `network.safetensors` that Surmount wrote.",
        )
    if flags and not {f"normaliser/observation/{n}" for n in ("mean", "var")} <= set(
        network.tensors
    ):
        raise InputError(
            "The network normalises observations, and the file does not say how.",
            remedy="Give a `network.safetensors` that Surmount wrote.",
        )
    if not all(
        np.isfinite(value).all() for name, value in network.tensors.items() if name[:7] == "policy/"
    ):
        raise InputError(
            "The network has weights that are not finite.",
            remedy="Give another network, or train it anew.",
        )


def action_divisor(network: Snapshot) -> float:
    """Return what the network's draws are divided by before they are clipped.

    Raises
    ------
    InputError
        If the record says something else than a positive number.
    """
    divisor = network.record.get(ACTION_DIVISOR, 1.0)
    if not _is_positive(divisor):
        raise _wrong_record(ACTION_DIVISOR, divisor)
    return float(divisor)


def noise_correlation(network: Snapshot) -> float:
    """Return the correlation of the network's exploration noise from step to step.

    Raises
    ------
    InputError
        If the record does not hold two positive times.
    """
    noise = network.record.get(NOISE)
    if noise is None:
        return 0.0
    try:
        found = renamed(noise)
        time_s, interval_s = found["correlation_s"], found["step_s"]
    except (KeyError, TypeError, AttributeError):
        raise _wrong_record(NOISE, noise) from None
    if not (_is_positive(time_s) and _is_positive(interval_s)):
        raise _wrong_record(NOISE, noise)
    return math.exp(-interval_s / time_s)


def _is_positive(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 < value < math.inf


def _wrong_record(key: str, value: object) -> InputError:
    return InputError(
        f"The network's record says {key} {str(value)[:80]}.",
        remedy="Give a `network.safetensors` that Surmount wrote.",
    )


def _seal(tensors: Mapping[str, np.ndarray], record: str) -> str:
    """Return the SHA-256 over a record and over names, shapes and contents of tensors."""
    digest = hashlib.sha256(record.encode())
    for name, array in sorted(tensors.items()):
        digest.update(canonical_json([name, str(array.dtype), list(array.shape)]).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _damaged(path: Path) -> IntegrityError:
    return IntegrityError(
        f"The checkpoint {path} was changed or damaged after it was written.",
        remedy=f"Delete {path.parent} and run again: only this stage begins anew.",
    )


def acting_only(network: Snapshot) -> Snapshot:
    """Return a network without what only learning needs: critic, optimiser, scale of rewards."""
    return replace(
        network,
        tensors={
            name: array
            for name, array in network.tensors.items()
            if name.startswith(_ACTING) and not name.startswith(_JUDGING)
        },
    )


def missing_weights(policy: torch.nn.Module, tensors: Mapping[str, np.ndarray]) -> list[str]:
    """Return the weights that a policy needs to act and that are not there."""
    needed = (f"policy/{name}" for name in policy.state_dict())
    return [name for name in needed if name not in tensors and not name.startswith(_JUDGING)]


def take(model: PPO, normaliser: VecNormalize) -> Tensors:
    """Return copies of a model's weights, optimiser state and normalisation statistics."""
    tensors = {
        f"policy/{name}": value.detach().numpy().copy()
        for name, value in model.policy.state_dict().items()
    }
    for index, moments in model.policy.optimizer.state_dict()["state"].items():
        for name, value in moments.items():
            tensors[f"optimiser/{index}/{name}"] = torch.as_tensor(value).numpy().copy()
    for name, statistics in _statistics(normaliser).items():
        tensors[f"normaliser/{name}/mean"] = np.asarray(statistics.mean, dtype=np.float64)
        tensors[f"normaliser/{name}/var"] = np.asarray(statistics.var, dtype=np.float64)
        tensors[f"normaliser/{name}/count"] = np.asarray(statistics.count, dtype=np.float64)
    return tensors


def put(tensors: Mapping[str, np.ndarray], model: PPO, normaliser: VecNormalize) -> None:
    """Give a model the weights, optimiser state and normalisation statistics taken before."""
    model.policy.load_state_dict(policy_weights(tensors))
    optimiser = model.policy.optimizer.state_dict()
    moments: dict[int, dict[str, torch.Tensor]] = {}
    for name, value in tensors.items():
        if name.startswith("optimiser/"):
            _, index, moment = name.split("/")
            moments.setdefault(int(index), {})[moment] = torch.from_numpy(value.copy())
    model.policy.optimizer.load_state_dict({**optimiser, "state": moments})
    for name, statistics in _statistics(normaliser).items():
        statistics.mean = tensors[f"normaliser/{name}/mean"].copy()
        statistics.var = tensors[f"normaliser/{name}/var"].copy()
        statistics.count = float(tensors[f"normaliser/{name}/count"])


def policy_weights(tensors: Mapping[str, np.ndarray]) -> dict[str, torch.Tensor]:
    """Return the weights of the policy as PyTorch wants them."""
    prefix = "policy/"
    return {
        name.removeprefix(prefix): torch.from_numpy(value.copy())
        for name, value in tensors.items()
        if name.startswith(prefix)
    }


def _statistics(normaliser: VecNormalize) -> dict[str, RunningMeanStd]:
    statistics: dict[str, RunningMeanStd] = {"reward": normaliser.ret_rms}
    if normaliser.norm_obs:
        statistics["observation"] = cast("RunningMeanStd", normaliser.obs_rms)
    return statistics
